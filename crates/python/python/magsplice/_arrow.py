"""Tables for pandas, polars and other tools, through the Arrow C stream interface."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Column = NDArray[Any] | list[str] | list[str | None]


class Table:
    """A result with one row for each item.

    Any reader of the Arrow PyCapsule interface takes it without a copy: ``polars.DataFrame(x)``,
    ``pyarrow.table(x)``, and pandas with
    ``pyarrow.table(x).to_pandas(types_mapper=pandas.ArrowDtype)``. In pandas 3 there is also
    ``pandas.DataFrame.from_arrow(x)``, which copies columns of one type into one block. All need
    the small package nanoarrow: ``pip install "magsplice[tables]"``.
    """

    def columns(self) -> dict[str, Column]:
        """Columns by name: contiguous arrays and lists of texts, all of one length.

        A missing text is None.
        """
        raise NotImplementedError

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Stream of one batch, for readers of Arrow tables."""
        try:
            import nanoarrow
        except ImportError as error:
            raise ImportError(
                'tables need the package nanoarrow: pip install "magsplice[tables]"'
            ) from error
        columns = self.columns()

        def array_of(column: Column) -> Any:
            if not isinstance(column, np.ndarray):
                return nanoarrow.c_array(column, nanoarrow.string())
            if len(column):
                return nanoarrow.c_array(column)
            # An array without elements has no type there.
            kind = "bool_" if column.dtype == bool else column.dtype.name
            return nanoarrow.c_array([], getattr(nanoarrow, kind)())

        arrays = [array_of(column) for column in columns.values()]
        schema = nanoarrow.struct(
            {name: array.schema for name, array in zip(columns, arrays, strict=True)}
        )
        rows = len(next(iter(columns.values())))
        batch = nanoarrow.c_array_from_buffers(schema, rows, buffers=[None], children=arrays)
        return nanoarrow.c_array_stream(batch).__arrow_c_stream__(requested_schema)


def split(names: tuple[str, ...], rows: NDArray[np.float64]) -> dict[str, Column]:
    """One contiguous column for each column of an array of shape (n, len(names))."""
    columns = np.ascontiguousarray(rows.reshape(-1, len(names)).T)
    return dict(zip(names, columns, strict=True))
