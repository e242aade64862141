"""Files of magsplice read back with their target tools; `.ci/readback` runs it.

CSV is the reference: its digits read back to the same numbers, so other formats must hold
these numbers bit by bit.
"""

import csv
import json
import subprocess
import sys
import tempfile
import tomllib
import unittest
from hashlib import sha256
from pathlib import Path

import ezdxf
import ezdxf.bbox
import numpy as np
import pyarrow.parquet
import trimesh
from ezdxf.lldxf.encoding import decode_dxf_unicode
from scipy.spatial.transform import Rotation
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader

HERE = Path(__file__).parent
PUBLISHED = HERE / "../../layouts/published-film.toml"
TURNED = HERE / "turned.toml"
SINGULAR = HERE / "singular.toml"

POINT = ["x_mm", "y_mm", "z_mm"]
B = ["bx_t", "by_t", "bz_t"]
PARAMETERS = ["r_x_rad", "r_y_rad", "s_z"]
# Vectors and scalars of VTK, and their columns elsewhere.
QUANTITIES = {"b_t": B} | {name: [name] for name in PARAMETERS}

# magpylib takes differences of terms as large as J, 0.1 T to 1 T, for fields of 1 mT:
# at the points of these films its error is at most 2.5e-13 of |B|. A tile that is
# 1e-11 mm wider is detected.
MAGPYLIB_IS_OFF_BY = 1e-12


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{arguments}: {done.stderr}")
    return done


def read_csv(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    columns = zip(*((float(cell) for cell in row) for row in rows[1:]))
    return dict(zip(rows[0], map(np.array, columns)))


def read_vtk(reader, path):
    """The dataset, and its point data and facts by name."""
    complaints = []
    reader.AddObserver("ErrorEvent", lambda *_: complaints.append(path))
    reader.AddObserver("WarningEvent", lambda *_: complaints.append(path))
    reader.SetFileName(str(path))
    reader.Update()
    if complaints:
        raise AssertionError(f"VTK cannot read {path}")
    data = reader.GetOutput()
    return data, arrays(data.GetPointData()), arrays(data.GetFieldData())


def arrays(fields):
    found = {}
    for i in range(fields.GetNumberOfArrays()):
        array = fields.GetAbstractArray(i)
        if array.IsA("vtkStringArray"):
            found[array.GetName()] = [array.GetValue(j) for j in range(array.GetNumberOfValues())]
        else:
            found[array.GetName()] = vtk_to_numpy(array)
    return found


def component_names(array):
    return [array.GetComponentName(i) for i in range(array.GetNumberOfComponents())]


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, verb, layout, name, *options):
        path = self.folder / f"{verb}-{Path(layout).stem}{name}"
        run(verb, layout, "-o", path, *options)
        return path

    def same(self, found, wanted, what):
        """The same numbers, bit by bit."""
        found, wanted = np.ravel(found), np.ravel(wanted)
        self.assertEqual((found.dtype, found.shape), (np.dtype("f8"), wanted.shape), what)
        nan = np.isnan(wanted)
        np.testing.assert_array_equal(np.isnan(found), nan, what)
        np.testing.assert_array_equal(found[~nan].view("i8"), wanted[~nan].view("i8"), what)

    def tables(self):
        """Verb, layout, options, the values of the CSV file, and the shape of the grid."""
        for layout, shape in [(PUBLISHED, (9, 9, 5)), (TURNED, (41, 6, 7))]:
            for verb, options in [
                ("field", []),
                ("field", ["--within", "1e-7"]),
                ("field", ["--quantity", "gradient"]),
                ("decouple", []),
            ]:
                wanted = read_csv(self.write(verb, layout, ".csv", *options))
                names = POINT + B + (PARAMETERS if verb == "decouple" else [])
                if "gradient" in options:
                    names = POINT + [f"db{b}_d{x}_t_per_mm" for b in "xyz" for x in "xyz"]
                self.assertEqual(list(wanted), names)
                self.assertEqual(wanted["x_mm"].shape, (np.prod(shape),))
                with self.subTest(verb=verb, layout=layout.name, options=options):
                    yield verb, layout, options, wanted, shape

    def check_facts(self, facts, layout, verb, options):
        """Facts as text."""
        bytes_ = Path(layout).read_bytes()
        written = tomllib.loads(bytes_.decode())
        self.assertEqual(facts["layout"], written["name"])
        self.assertEqual(facts["sha256"], sha256(bytes_).hexdigest())
        self.assertEqual(f"magsplice {facts['version']}\n", run("--version").stdout)
        self.assertEqual(facts["accuracy"], "within 1e-7 of |B|" if "--within" in options else "exact")
        self.assertEqual(facts["tiles"], "56" if layout == PUBLISHED else "3")
        if verb == "decouple":
            report = json.loads(run("decouple", layout, "--format", "json").stdout)
            rmse = list(report["uniformity_rmse"].values())
            self.assertEqual(json.loads(facts["uniformity_rmse"]), rmse)
            self.assertEqual(json.loads(facts["reference_mm"]), written["volume"]["reference_mm"])
            self.assertEqual(facts["singular_points"], "0")


class Json(Case):
    def test_columns_are_those_of_csv(self):
        for verb, layout, options, wanted, shape in self.tables():
            read = json.loads(self.write(verb, layout, ".json", *options).read_text())
            self.assertEqual(list(read["columns"]), list(wanted))
            self.assertEqual((read["shape"], read["points"]), (list(shape), np.prod(shape)))
            for name, column in wanted.items():
                self.same(np.array(read["columns"][name]), column, name)
            accuracy = {"relative": 1e-7} if "--within" in options else "exact"
            self.assertEqual(read["accuracy"], accuracy)
            facts = read | {"accuracy": "within 1e-7 of |B|" if "--within" in options else "exact"}
            self.check_facts(facts | {"tiles": str(read["tiles"])}, layout, "field", options)


class NumPy(Case):
    def test_npz(self):
        for verb, layout, options, wanted, shape in self.tables():
            with np.load(self.write(verb, layout, ".npz", *options)) as read:
                self.assertEqual(read.files[: len(wanted)], list(wanted))
                for name, column in wanted.items():
                    self.assertEqual(read[name].shape, shape)
                    self.same(read[name], column, name)
                facts = {name: read[name].tolist() for name in read.files[len(wanted) :]}
                self.assertEqual(facts["layout"], str(read["layout"]))
                self.check_facts({name: str(fact) for name, fact in facts.items()}, layout, verb, options)

    def test_npy(self):
        for verb, layout, options, wanted, shape in self.tables():
            read = np.load(self.write(verb, layout, ".npy", *options))
            self.assertEqual((read.shape, list(read.dtype.names)), (shape, list(wanted)))
            for name, column in wanted.items():
                self.same(read[name], column, name)
            # x varies along the first axis, z along the last.
            self.assertTrue((np.diff(read["x_mm"], axis=0) > 0).all() and (np.diff(read["z_mm"], axis=2) > 0).all())

    def test_points_of_a_file(self):
        points = self.folder / "points.csv"
        points.write_text("x_mm,y_mm,z_mm\n0.1,2,-4\n-7,1e-300,-0.0\n")
        wanted = read_csv(self.write("field", PUBLISHED, ".csv", "--points", points))
        with np.load(self.write("field", PUBLISHED, ".npz", "--points", points)) as read:
            for name, column in wanted.items():
                self.assertEqual(read[name].shape, (2,))
                self.same(read[name], column, name)


class ParquetFiles(Case):
    def test_columns_and_metadata(self):
        for verb, layout, options, wanted, _ in self.tables():
            read = pyarrow.parquet.read_table(self.write(verb, layout, ".parquet", *options))
            self.assertEqual(read.column_names, list(wanted))
            for name, column in wanted.items():
                self.assertEqual(read[name].null_count, 0)
                self.same(read[name].to_numpy(), column, name)
            facts = {key.decode(): value.decode() for key, value in read.schema.metadata.items()}
            self.check_facts(facts, layout, verb, options)

    def test_more_than_one_row_group(self):
        fine = self.folder / "fine.toml"
        single = (HERE / "../../layouts/single-tile.toml").read_text()
        fine.write_text(single.replace("step_mm = 0.5", "step_mm = [0.0625, 0.0625, 0.0625]"))
        read = pyarrow.parquet.ParquetFile(self.write("field", fine, ".parquet"))
        self.assertEqual((read.metadata.num_rows, read.metadata.num_row_groups), (129 * 129 * 65, 2))
        table = read.read()
        with np.load(self.write("field", fine, ".npz")) as wanted:
            for name in POINT + B:
                self.same(table[name].to_numpy(), wanted[name], name)


class Vtk(Case):
    def check(self, data, read, wanted, order):
        columns = [name for name in wanted if name not in POINT]
        quantities = {"gradient_b_t_per_mm": columns} if len(columns) == 9 else QUANTITIES
        quantities = {name: names for name, names in quantities.items() if names[0] in wanted}
        self.assertEqual(list(read), list(quantities))
        for name, names in quantities.items():
            if len(names) > 1:
                self.assertEqual(component_names(data.GetPointData().GetArray(name)), names)
            for i, column in enumerate(names):
                component = read[name][:, i] if len(names) > 1 else read[name]
                self.same(component, order(wanted[column]), column)

    def facts(self, facts):
        text = lambda fact: fact[0] if isinstance(fact, list) else json.dumps(fact.tolist())
        counts = {name: str(facts[name][0]) for name in ("tiles", "singular_points") if name in facts}
        return {name: text(fact) for name, fact in facts.items()} | counts

    def test_image_data(self):
        for verb, layout, options, wanted, shape in self.tables():
            data, read, facts = read_vtk(vtkXMLImageDataReader(), self.write(verb, layout, ".vti", *options))
            self.assertEqual(data.GetDimensions(), shape)
            # In VTK x runs fastest.
            order = lambda column: column.reshape(shape).transpose(2, 1, 0).ravel().copy()
            self.check(data, read, wanted, order)
            points = np.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])
            for axis, name in enumerate(POINT):
                # The origin and some steps, rounded.
                np.testing.assert_allclose(points[:, axis], order(wanted[name]), rtol=0, atol=4e-15)
            self.check_facts(self.facts(facts), layout, verb, options)

    def test_points_of_a_file(self):
        points = self.write("field", TURNED, ".csv")
        wanted = read_csv(points)
        data, read, facts = read_vtk(vtkXMLPolyDataReader(), self.write("field", TURNED, ".vtp", "--points", points))
        self.check(data, read, wanted, lambda column: column)
        self.same(vtk_to_numpy(data.GetPoints().GetData()).T, np.array([wanted[name] for name in POINT]), "points")
        self.assertEqual(data.GetNumberOfVerts(), len(wanted["x_mm"]))
        cell = data.GetCell(7)
        self.assertEqual((cell.GetNumberOfPoints(), cell.GetPointId(0)), (1, 7))
        self.check_facts(self.facts(facts), TURNED, "field", [])

    def test_tiles(self):
        for layout in [PUBLISHED, TURNED]:
            with self.subTest(layout=layout.name):
                data, _, facts = read_vtk(vtkXMLPolyDataReader(), self.write("export", layout, ".vtp"))
                tiles = json.loads(run("tiles", layout, "--format", "json").stdout)["tile"]
                self.check_tiles(data, tiles)
                self.check_facts(self.facts(facts) | {"accuracy": "exact"}, layout, "field", [])

    def check_tiles(self, data, tiles):
        cells = arrays(data.GetCellData())
        points = vtk_to_numpy(data.GetPoints().GetData())
        self.assertEqual((len(points), data.GetNumberOfPolys()), (8 * len(tiles), 6 * len(tiles)))
        faces = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 6, 4)
        self.assertEqual(cells["tile"], [tile["name"] for tile in tiles for _ in range(6)])
        self.assertEqual(cells["tile_index"].tolist(), [i for i in range(len(tiles)) for _ in range(6)])
        self.assertEqual(component_names(data.GetCellData().GetArray("polarization_t")), ["jx_t", "jy_t", "jz_t"])
        for i, tile in enumerate(tiles):
            corners = points[faces[i]]
            np.testing.assert_allclose(corners.mean(axis=(0, 1)), tile["position_mm"], atol=1e-14)
            # Outward faces: each with the middle spans a positive part of the volume.
            rays = corners - corners.mean(axis=(0, 1))
            parts = np.einsum("fi,fi->f", rays[:, 0], np.cross(rays[:, 1], rays[:, 2])) / 3
            np.testing.assert_allclose(parts, np.prod(tile["size_mm"]) / 6, rtol=1e-13)
            edges = np.linalg.norm(rays - np.roll(rays, 1, axis=1), axis=2).ravel()
            np.testing.assert_allclose(np.unique(edges.round(12)), np.unique(tile["size_mm"]), atol=1e-12)
            rotation = tile.get("rotation", {"axis": [0, 0, 1], "angle_deg": 0})
            axis = np.array(rotation["axis"]) / np.linalg.norm(rotation["axis"])
            turn = Rotation.from_rotvec(np.radians(rotation["angle_deg"]) * axis)
            middles = np.sort(rays.mean(axis=1) @ turn.as_matrix(), axis=0)
            half = np.array(tile["size_mm"]) / 2
            np.testing.assert_allclose(middles[0], -half, atol=1e-14)
            np.testing.assert_allclose(middles[-1], half, atol=1e-14)
            wanted = turn.apply(tile["polarization_t"])
            np.testing.assert_allclose(cells["polarization_t"][6 * i : 6 * i + 6], [wanted] * 6, atol=1e-15)


class Singular(Case):
    def test_singular_points_are_nan_and_counted(self):
        wanted = read_csv(self.write("decouple", SINGULAR, ".csv"))
        nan = wanted["x_mm"] == 0
        self.assertEqual(nan.sum(), 6)
        for name in PARAMETERS:
            np.testing.assert_array_equal(np.isnan(wanted[name]), nan)
        read = np.load(self.write("decouple", SINGULAR, ".npz"))
        table = pyarrow.parquet.read_table(self.write("decouple", SINGULAR, ".parquet"))
        report = json.loads(self.write("decouple", SINGULAR, ".json").read_text())
        _, points, facts = read_vtk(vtkXMLImageDataReader(), self.write("decouple", SINGULAR, ".vti"))
        for name in PARAMETERS:
            self.same(read[name], wanted[name], name)
            self.same(table[name].to_numpy(), wanted[name], name)
            self.same(np.array(report["columns"][name], dtype=float), wanted[name], name)
            self.assertEqual(np.isnan(points[name]).sum(), 6)
        counts = [read["singular_points"], table.schema.metadata[b"singular_points"], facts["singular_points"][0]]
        self.assertEqual([int(count) for count in counts], [6, 6, 6])
        self.assertEqual(len(report["singular_points_mm"]), 6)
        said = run("decouple", SINGULAR, "-o", self.folder / "out.npy").stderr
        self.assertIn("6 singular points", said)
        self.assertEqual(run("decouple", SINGULAR, "-o", self.folder / "out.npy", "--quiet").stderr, "")


class Cad(Case):
    def test_drawing_is_clean_and_in_mm(self):
        for layout, tiles in [(PUBLISHED, 56), (TURNED, 3)]:
            with self.subTest(layout=layout.name):
                drawing = ezdxf.readfile(self.write("export", layout, ".dxf"))
                audit = drawing.audit()
                self.assertEqual((audit.errors, audit.fixes), ([], []))
                self.assertEqual(drawing.header["$INSUNITS"], ezdxf.units.MM)
                outlines = drawing.modelspace().query("POLYLINE")
                self.assertEqual(len(outlines), tiles)
                self.assertTrue(all(outline.is_closed for outline in outlines))
                layers = {layer.dxf.name for layer in drawing.layers}
                parts = run("tiles", layout, "--format", "csv").stdout.splitlines()[1:]
                self.assertEqual({name for name in layers if name.startswith("PART-")}, {f"PART-{i + 1}" for i in range(len(parts))})
                for i, part in enumerate(parts):
                    on_layer = outlines.query(f'*[layer=="PART-{i + 1}"]')
                    self.assertEqual(len(on_layer), int(part.split(",")[1]))
                    # A name in each outline, within its box.
                    names = drawing.modelspace().query(f'TEXT[layer=="PART-{i + 1}"]')
                    named = [decode_dxf_unicode(name.plain_text()) for name in names]
                    self.assertEqual(named, list(csv.reader([part]))[0][8].split(";"))
                    for name, outline in zip(names, on_layer):
                        corners = np.array([vertex.dxf.location for vertex in outline.vertices])
                        box = ezdxf.bbox.extents([name])
                        for axis in range(2):
                            self.assertLess(corners[:, axis].min(), box.extmin[axis])
                            self.assertLess(box.extmax[axis], corners[:, axis].max())
                    if layout == PUBLISHED:
                        for outline in on_layer:
                            corners = np.array([vertex.dxf.location for vertex in outline.vertices])
                            sides = sorted(np.ptp(corners, axis=0)[:2], reverse=True)
                            np.testing.assert_allclose(sides, [float(side) for side in part.split(",")[2:4]], atol=1e-12)

    def test_bodies_are_watertight_with_the_volume_of_the_tiles(self):
        for layout in [PUBLISHED, TURNED]:
            with self.subTest(layout=layout.name):
                tiles = json.loads(run("tiles", layout, "--format", "json").stdout)["tile"]
                mesh = trimesh.load(self.write("export", layout, ".stl"), process=False)
                self.assertEqual(len(mesh.faces), 12 * len(tiles))
                for i, tile in enumerate(tiles):
                    faces = mesh.triangles[12 * i : 12 * i + 12]
                    body = trimesh.Trimesh(**trimesh.triangles.to_kwargs(faces), process=True)
                    self.assertTrue(body.is_watertight and body.is_winding_consistent)
                    np.testing.assert_allclose(body.volume, np.prod(tile["size_mm"]), rtol=1e-5)
                    np.testing.assert_allclose(body.center_mass, tile["position_mm"], atol=1e-5)


class Magpylib(Case):
    def test_script_prints_the_same_field(self):
        for layout in [PUBLISHED, TURNED]:
            with self.subTest(layout=layout.name):
                script = self.write("export", layout, ".py")
                points = self.write("field", layout, ".csv")
                reference = tomllib.loads(Path(layout).read_text())["volume"]["reference_mm"]
                self.check(script, points, layout, reference)

    def check(self, script, points, layout, reference):
        for arguments, count in [([], 0), ([points], None)]:
            command = [sys.executable, str(script), *map(str, arguments)]
            printed = self.folder / "printed.csv"
            printed.write_text(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
            found = read_csv(printed)
            # The points it printed, the reference first, through magsplice.
            wanted = read_csv(self.write("field", layout, "-again.csv", "--points", printed))
            self.assertEqual([found[name][0] for name in POINT], reference)
            given = read_csv(points) if count is None else {name: np.array([]) for name in POINT}
            for name in POINT:
                self.same(found[name][1:], given[name], name)
            found, wanted = (np.stack([table[name] for name in B]) for table in (found, wanted))
            error = np.linalg.norm(found - wanted, axis=0) / np.linalg.norm(wanted, axis=0)
            self.assertLess(error.max(), MAGPYLIB_IS_OFF_BY)


MAGNETS = """
import magpylib as magpy
from ezdxf.lldxf.encoding import decode_dxf_unicode
from scipy.spatial.transform import Rotation

J = (0.1, -0.2, 0.3)
def cuboid(x, label=None, **kwargs):
    return magpy.magnet.Cuboid(
        position=(x, 0.1e-3, -0.7e-3), dimension=(3.3e-3, 1.7e-3, 1e-3), polarization=J, style_label=label, **kwargs
    )
inner = magpy.Collection(
    cuboid(0.01, "a", orientation=Rotation.from_euler("xyz", (10, 20, 30), degrees=True)), cuboid(0.02, "a")
)
inner.rotate_from_angax(33, (1, 2, 3), anchor=0)
blocks = magpy.Collection(inner, cuboid(-0.02), magpy.Sensor())
magnetized = [magpy.magnet.Cuboid(dimension=(1e-3, 1e-3, 1e-3), magnetization=(1e5, 0, -2e5))]
mixed = [magpy.magnet.Cylinder(dimension=(1, 1), polarization=J, style_label="round"), cuboid(0), inner,
         cuboid(1).move([(1, 0, 0)] * 3), magpy.current.Circle(diameter=1, current=1), magpy.magnet.Cuboid()]
"""


class MagpylibImport(Case):
    def setUp(self):
        super().setUp()
        self.script = self.folder / "blocks_from_magpylib.py"
        run("export", "--to", "magpylib-import", "-o", self.script)
        (self.folder / "magnets.py").write_text(MAGNETS)

    def python(self, *arguments):
        command = [sys.executable, str(self.script), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, cwd=self.folder)

    def test_collection_has_the_same_field(self):
        sys.path.insert(0, str(self.folder))
        self.addCleanup(sys.path.remove, str(self.folder))
        self.addCleanup(sys.modules.pop, "magnets", None)
        import magnets

        points = self.folder / "points.csv"
        places = np.random.default_rng(1).uniform(-8, 8, (50, 3)) + [0, 0, -12]
        np.savetxt(points, places, header="x,y,z", fmt="%.17g")
        for variable, names in [("blocks", ["a", "a-2", "tile-3"]), ("magnetized", ["tile-1"]), ("inner", ["a", "a-2"])]:
            table, layout = self.folder / "blocks.csv", self.folder / "film.toml"
            done = self.python(f"magnets:{variable}", table)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
            self.assertEqual(self.python(f"magnets.py:{variable}").stdout, table.read_text())
            run("import", table, "-o", layout)
            tiles = json.loads(run("tiles", layout, "--format", "json").stdout)["tile"]
            self.assertEqual([tile["name"] for tile in tiles], names)
            out = self.folder / "out.csv"
            run("field", layout, "--points", points, "--unit", "mm", "-o", out)
            found = read_csv(out)
            self.same(np.stack([found[name] for name in POINT], axis=1), places, "points")
            collection = magnets.__dict__[variable]
            wanted = magnets.magpy.getB(collection, places / 1000.0, sumup=True)
            found = np.stack([found[name] for name in B], axis=1)
            error = np.linalg.norm(found - wanted, axis=1) / np.linalg.norm(wanted, axis=1)
            # Up to ten sizes from a block the differences of magpylib lose another digit.
            self.assertLess(error.max(), 10 * MAGPYLIB_IS_OFF_BY)

    def test_film_goes_there_and_back(self):
        for layout in [PUBLISHED, TURNED]:
            film = self.write("export", layout, ".py")
            done = self.python(f"{film}:film", self.folder / "blocks.csv")
            self.assertEqual(done.returncode, 0, done.stderr)
            run("import", self.folder / "blocks.csv", "-o", self.folder / "again.toml")
            read = lambda path: json.loads(run("tiles", path, "--format", "json").stdout)["tile"]
            for tile, again in zip(read(layout), read(self.folder / "again.toml"), strict=True):
                self.assertEqual((tile["name"], tile["polarization_t"]), (again["name"], again["polarization_t"]))
                for key in ["position_mm", "size_mm"]:
                    # The script divides by 1000, which rounds.
                    np.testing.assert_allclose(again[key], tile[key], rtol=3e-16, atol=0)

    def test_other_objects_are_named(self):
        done = self.python("magnets:mixed", self.folder / "blocks.csv")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        for message in [
            "magnets:mixed: Cylinder 'round' (number 1) is no cuboid",
            "(number 5) has a path of",
            "Circle",
            "(number 7) has no dimension",
        ]:
            self.assertIn(message, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 4)
        self.assertFalse((self.folder / "blocks.csv").exists())
        for name in ["magnets", "magnets:nothing", "none.py:x", "magnets:J"]:
            done = self.python(name)
            self.assertEqual(done.returncode, 1)
            self.assertNotIn("Traceback", done.stderr)
        self.assertIn("write_blocks(collection", self.python().stderr)


if __name__ == "__main__":
    PROGRAM = str(Path(sys.argv.pop(1)).resolve())
    unittest.main()
