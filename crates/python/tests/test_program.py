"""The program in the wheel.

Its output, exit status and signals are those of the program of the environment variable MAGSPLICE,
where it is set.
"""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
from conftest import LAYOUTS

import magsplice

PROGRAM = [shutil.which("magsplice", path=sysconfig.get_path("scripts"))]
MODULE = [sys.executable, "-m", "magsplice"]
NATIVE = os.environ.get("MAGSPLICE")
FILM = LAYOUTS / "published-film.toml"

#: A film and volume whose field takes minutes.
LARGE = """format = 1
name = "large"
[volume]
x_mm = [-2, 2]
y_mm = [-2, 2]
z_mm = [-5, -4.5]
step_mm = 0.01
[[lattice]]
name = "film"
start_mm = [-200.85, -200.85, 0]
height_mm = 1
strength_t = 0.12
x = [{ widths_mm = [3.3, 1.7, 3.3, 1.7], pattern = [1, 0, -1, 0], times = 40 }]
"""

posix = pytest.mark.skipif(os.name != "posix", reason="signals and terminals of POSIX")


def outcome(command, **options):
    """Exit status, standard output and standard error."""
    ended = subprocess.run(command, capture_output=True, timeout=120, **options)
    return ended.returncode, ended.stdout, ended.stderr


def run(*arguments, program=PROGRAM, **options):
    """The outcome of the program in the wheel, equal to that of the program alone."""
    found = outcome([*program, *arguments], **options)
    if NATIVE:
        assert found == outcome([NATIVE, *arguments], **options)
    return found


def start(*arguments, **options):
    """The program, started with the handler of Ctrl-C that a shell gives it."""

    def reset():
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    return subprocess.Popen([*PROGRAM, *arguments], preexec_fn=reset, **options)


@contextlib.contextmanager
def terminal(columns=80):
    """Both sides of a terminal: of the program, and of the person."""
    import fcntl
    import struct
    import termios

    seen, given = os.openpty()
    fcntl.ioctl(given, termios.TIOCSWINSZ, struct.pack("HHHH", 25, columns, 0, 0))
    try:
        yield given, seen
    finally:
        os.close(seen)


def watch(seen, enough=None):
    """The text on a terminal until its other side is closed or the text has `enough`."""
    text = ""
    # Linux reports a closed side as an error.
    with contextlib.suppress(OSError):
        while (read := os.read(seen, 4096)) and not (enough and enough in text):
            text += read.decode()
    return text


@pytest.mark.parametrize("program", [PROGRAM, MODULE])
def test_success_is_status_0(program):
    status, printed, said = run("decouple", FILM, program=program)
    assert (status, said) == (0, b"")
    assert printed.startswith(b"published film: 56 tiles")
    version = run("--version", program=program)
    assert version == (0, f"magsplice {magsplice.__version__}\n".encode(), b"")


def test_broken_expectations_are_status_1(tmp_path):
    layout = tmp_path / "broken.toml"
    expect = "[expect]\namplitude = { min = 0.9 }\n\n"
    layout.write_text(re.sub(r"\[expect\]\n.*?\n\n", expect, FILM.read_text(), flags=re.DOTALL))
    status, printed, _ = run("check", layout)
    assert status == 1
    assert b"amplitude" in printed


def test_bad_input_is_status_2(tmp_path):
    for arguments in [("decouple", tmp_path / "none.toml"), ("decouple", "--none"), ("nonsense",)]:
        status, printed, said = run(*arguments)
        assert (status, printed) == (2, b"")
        assert said
        assert b"Traceback" not in said
    assert b"Usage: magsplice decouple" in run("decouple")[2]
    assert run()[0] == 2


@pytest.mark.parametrize("program", [PROGRAM, MODULE])
def test_help_is_as_wide_as_the_terminal(program):
    for columns in ("60", "100"):
        environment = {**os.environ, "COLUMNS": columns}
        status, printed, _ = run("help", "decouple", program=program, env=environment)
        assert status == 0
        assert b"Usage: magsplice decouple" in printed
    if os.name == "posix":
        texts = []
        for command in [program, *([[NATIVE]] if NATIVE else [])]:
            with terminal(50) as (given, seen):
                shown = subprocess.Popen([*command, "decouple", "--help"], stdout=given)
                os.close(given)
                texts.append(watch(seen))
                assert shown.wait() == 0
        assert set(texts) == {texts[0]}
        lines = re.sub("\x1b\\[[0-9;]*m", "", texts[0]).split("\r\n")
        assert max(map(len, lines)) <= 50


def test_standard_input_is_read():
    points = b"x_mm,y_mm,z_mm\n0,0,-5\n1,0,-5\n"
    status, printed, _ = run("field", FILM, "--points", "-", input=points)
    assert status == 0
    assert printed.count(b"\n") >= 3


@posix
def test_paths_may_be_no_utf_8(tmp_path):
    path = os.path.join(os.fsencode(tmp_path), b"fil\xffm \xc3\xa9.toml")
    try:
        shutil.copyfile(FILM, path)
    except OSError:
        pytest.skip("the file system takes UTF-8 alone")
    for locale in ("C", "C.UTF-8", "POSIX"):
        environment = {**os.environ, "LC_ALL": locale}
        assert run("decouple", path, env=environment)[0] == 0
        assert run("decouple", path + b"\xfe", env=environment)[0] == 2


@posix
def test_closed_pipes_end_the_program_quietly(tmp_path):
    (tmp_path / "large.toml").write_text(LARGE.replace("0.01", "0.1"))
    program = start(
        "field", "large.toml", cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert program.stdout.readline().startswith(b"x_mm")
    program.stdout.close()
    assert program.stderr.read() == b""
    assert program.wait() == 0


@posix
@pytest.mark.parametrize("redirection", [">&-", "<&-", "2>&-", "<&- >&- 2>&-", ">/dev/full"])
def test_streams_may_be_closed_or_full(redirection, tmp_path):
    if "full" in redirection and not Path("/dev/full").exists():
        pytest.skip("no /dev/full")
    for arguments in [("decouple", FILM, "-o", "out.json"), ("decouple", FILM)]:
        found = []
        for command in [*PROGRAM, *([NATIVE] if NATIVE else [])]:
            script = f'"$@" {redirection}; echo $? >status'
            ended = outcome(["sh", "-c", script, "sh", command, *arguments], cwd=tmp_path)
            out = tmp_path / "out.json"
            written = out.read_bytes() if out.exists() else None
            found.append((ended, (tmp_path / "status").read_text(), written))
        assert found[0] == found[-1]


@posix
def test_limits_of_file_sizes_are_errors_of_writing(tmp_path):
    for command in [*PROGRAM, *([NATIVE] if NATIVE else [])]:
        # Python ignores this signal at its start.
        script = "trap '' XFSZ; ulimit -f 1; exec \"$@\""
        found = outcome(
            ["bash", "-c", script, "bash", command, "field", FILM, "-oout.csv"], cwd=tmp_path
        )
        assert found == (2, b"", b"magsplice: cannot write out.csv: File too large (os error 27)\n")


@posix
def test_interruptions_are_status_130_without_a_traceback(tmp_path):
    (tmp_path / "large.toml").write_text(LARGE)
    with terminal() as (given, seen):
        program = start("field", "large.toml", "-o", "out.csv", cwd=tmp_path, stderr=given)
        os.close(given)
        # The progress line: the work has begun.
        assert " of 8,200,851 points" in watch(seen, " of 8,200,851 points")
        program.send_signal(signal.SIGINT)
        said = watch(seen)
        assert program.wait() == 130
    assert "Traceback" not in said
    assert [path.name for path in tmp_path.iterdir()] == ["large.toml"]


@posix
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signals_before_anything_is_written_end_the_program(number, tmp_path):
    # The program waits for a point file that nobody writes.
    os.mkfifo(tmp_path / "points.csv")
    arguments = ("field", FILM, "--points", "points.csv")
    with terminal() as (given, seen):
        program = start(*arguments, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=given)
        os.close(given)
        assert "reading" in watch(seen, "reading")
        program.send_signal(number)
        said = watch(seen)
        # A shell reports 130 for both.
        assert program.wait() in (-number, 130)
    assert "Traceback" not in said


@posix
def test_colours_are_for_terminals():
    environment = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
    with terminal() as (given, seen):
        environment |= {"TERM": "xterm"}
        program = start("check", FILM, stdout=given, env=environment)
        os.close(given)
        assert "\x1b[32mok" in watch(seen)
        assert program.wait() == 0
    assert b"\x1b" not in run("check", FILM, env=environment)[1]


def test_program_starts_without_the_package():
    code = """
import sys
from _magsplice_program import main
sys.argv[1:] = ["--version"]
assert main() == 0
assert not {"numpy", "magsplice"} & set(sys.modules), sys.modules
"""
    assert outcome([sys.executable, "-c", code])[0] == 0
