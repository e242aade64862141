//! Scenes evaluated by magpylib in a Python process.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

use glam::DVec3;
use magsplice::field::Tile;

/// A Python process that holds a scene and evaluates it on request.
pub(crate) struct Magpylib {
    child: Child,
    answers: BufReader<ChildStdout>,
    points: usize,
    _files: [tempfile::NamedTempFile; 2],
}

impl Magpylib {
    /// Starts a process with a scene of `tiles`, evaluated at `points`.
    pub(crate) fn start(python: &Path, tiles: &[Tile], points: &[DVec3]) -> Result<Magpylib, String> {
        let mut table = [String::new(), String::new()];
        for tile in tiles {
            let numbers = [tile.size(), tile.polarization_t(), tile.position()].map(|v| v.to_array()).concat();
            let all: Vec<String> =
                numbers.iter().chain(&tile.rotation().to_array()).map(|n| format!("{n:?}")).collect();
            let _ = writeln!(table[0], "{}", all.join(","));
        }
        for point in points {
            let _ = writeln!(table[1], "{:?},{:?},{:?}", point.x, point.y, point.z);
        }
        let file = |text: &String| {
            let mut file = tempfile::NamedTempFile::new().map_err(|e| e.to_string())?;
            file.write_all(text.as_bytes()).map_err(|e| e.to_string())?;
            Ok::<_, String>(file)
        };
        let files = [file(&table[0])?, file(&table[1])?];
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/magpylib_scene.py");
        let mut child = Command::new(python)
            .arg(script)
            .args(files.iter().map(|f| f.path()))
            .env("OMP_NUM_THREADS", "1")
            // These variables keep numpy from returning its large arrays to the system and
            // allocating them anew, which doubles the time.
            .env("MALLOC_MMAP_THRESHOLD_", "1000000000")
            .env("MALLOC_TRIM_THRESHOLD_", "1000000000")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("cannot run {}: {e}", python.display()))?;
        let answers = BufReader::new(child.stdout.take().expect("piped"));
        Ok(Magpylib { child, answers, points: points.len(), _files: files })
    }

    /// Evaluates the scene. Returns the time in seconds.
    pub(crate) fn run(&mut self) -> Result<f64, String> {
        self.number_after("run")
    }

    /// B in tesla at all points, from the last run.
    pub(crate) fn field(&mut self) -> Result<Vec<DVec3>, String> {
        let first = self.number_after("field")?;
        let rest = (1..3 * self.points).map(|_| self.number());
        let numbers: Vec<f64> = std::iter::once(Ok(first)).chain(rest).collect::<Result<_, _>>()?;
        Ok(numbers.chunks_exact(3).map(DVec3::from_slice).collect())
    }

    fn number_after(&mut self, command: &str) -> Result<f64, String> {
        let input = self.child.stdin.as_mut().expect("piped");
        writeln!(input, "{command}").and_then(|()| input.flush()).map_err(|e| failed(&e))?;
        self.number()
    }

    fn number(&mut self) -> Result<f64, String> {
        let mut line = String::new();
        self.answers.read_line(&mut line).map_err(|e| failed(&e))?;
        line.trim().parse().map_err(|e| failed(&e))
    }
}

/// The version of magpylib that a Python can import; an error without magpylib.
pub(crate) fn magpylib_version(python: &Path) -> Result<String, String> {
    let script = "import magpylib; print(magpylib.__version__)";
    let output = Command::new(python).args(["-c", script]).output();
    let output = output.map_err(|e| format!("cannot run {}: {e}", python.display()))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    } else {
        Err(failed(&String::from_utf8_lossy(&output.stderr)))
    }
}

fn failed(e: &dyn std::fmt::Display) -> String {
    format!("magpylib's script failed (pip install magpylib, or --without-magpylib): {e}")
}

impl Drop for Magpylib {
    fn drop(&mut self) {
        // The process ends at the end of its input. If it fails there, no result is lost.
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}
