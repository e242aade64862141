"""The program `magsplice`.

It is a module beside the package, because importing the package, with NumPy, takes longer than most
commands.
"""

import os
import signal
import sys
from importlib.machinery import PathFinder
from types import ModuleType

#: The extension module.
EXTENSION = "magsplice._magsplice"


def main() -> int:
    """The exit status of the program with the arguments of this process."""
    _open_closed_streams()
    extension = sys.modules.get(EXTENSION) or _extension()
    _release_interrupts()
    status: int = extension.run_program(sys.argv[1:])
    return status


def _extension() -> ModuleType:
    """The extension module, loaded without its package."""
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "magsplice")
    spec = PathFinder.find_spec(EXTENSION, [folder])
    if spec is None or spec.loader is None:
        raise ImportError(f"no {EXTENSION} in {folder}", name=EXTENSION, path=folder)
    module = spec.loader.create_module(spec)
    if module is None:
        raise ImportError(f"{EXTENSION} is no extension module", name=EXTENSION, path=folder)
    spec.loader.exec_module(module)
    return module


def _open_closed_streams() -> None:
    """Opens closed standard streams, so that no file of the program becomes one of them."""
    while (opened := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(opened)


def _release_interrupts() -> None:
    """Gives Ctrl-C its default action back, unless it was ignored when Python began.

    Python ignores SIGPIPE, as a program in Rust does, and SIGXFSZ, which programs may inherit.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
