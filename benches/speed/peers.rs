//! The same scene by three programs, one after the other, again and again.

use std::fmt::Write as _;
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Quantity, Scene};
use magsplice_benches::{Magba, Workload, workloads};
use nalgebra::Vector3;

use crate::{Effort, median};

/// One scene.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    pub(crate) tiles: usize,
    pub(crate) points: usize,
    /// Nanoseconds for a tile and a point, median: magsplice, magba, magpylib if it was asked.
    pub(crate) ns: [Option<f64>; 3],
    /// How many times faster than magba and magpylib, median over interleaved pairs.
    pub(crate) ratios: [Option<f64>; 2],
}

pub(crate) fn measure(python: Option<&Path>, effort: Effort) -> Result<Vec<Row>, String> {
    workloads().into_iter().map(|workload| row(workload.thinned(effort.peer_pairs), python, effort)).collect()
}

fn row(workload: Workload, python: Option<&Path>, effort: Effort) -> Result<Row, String> {
    let pairs = workload.pairs() as f64;
    let Workload { name, tiles, points, .. } = workload;
    let scene = Scene::new(&tiles);
    let magba = Magba::new(&tiles, &points);
    let mut magpylib = python.map(|python| Magpylib::start(python, &tiles, &points)).transpose()?;
    let (mut ours, mut theirs) = (vec![DVec3::ZERO; points.len()], vec![Vector3::zeros(); points.len()]);
    let mut seconds: [Vec<f64>; 3] = [const { Vec::new() }; 3];
    for _ in 0..effort.runs {
        let start = Instant::now();
        scene.field_into(Quantity::FluxDensity, black_box(&points), &mut ours).map_err(|e| e.to_string())?;
        seconds[0].push(start.elapsed().as_secs_f64());
        let start = Instant::now();
        magba.field(&mut theirs);
        seconds[1].push(start.elapsed().as_secs_f64());
        if let Some(magpylib) = &mut magpylib {
            seconds[2].push(magpylib.run()?);
        }
    }
    let ratio = |peer: usize| {
        let pairs = seconds[peer].iter().zip(&seconds[0]);
        (!seconds[peer].is_empty()).then(|| median(pairs.map(|(theirs, ours)| theirs / ours).collect()))
    };
    Ok(Row {
        name,
        tiles: tiles.len(),
        points: points.len(),
        ratios: [ratio(1), ratio(2)],
        ns: seconds.map(|s| (!s.is_empty()).then(|| 1e9 * median(s) / pairs)),
    })
}

/// A Python that waits for its turn.
struct Magpylib {
    child: Child,
    _files: [tempfile::NamedTempFile; 2],
}

impl Magpylib {
    fn start(python: &Path, tiles: &[magsplice::field::Tile], points: &[DVec3]) -> Result<Magpylib, String> {
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
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("speed/magpylib_times.py");
        let child = Command::new(python)
            .arg(script)
            .args(files.iter().map(|f| f.path()))
            .env("OMP_NUM_THREADS", "1")
            // Without these numpy gives its large arrays back to the system and takes them again, at twice the time.
            .env("MALLOC_MMAP_THRESHOLD_", "1000000000")
            .env("MALLOC_TRIM_THRESHOLD_", "1000000000")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("cannot run {}: {e}", python.display()))?;
        Ok(Magpylib { child, _files: files })
    }

    /// Seconds of one run.
    fn run(&mut self) -> Result<f64, String> {
        let failed = |e: &dyn std::fmt::Display| {
            format!("magpylib's script failed (pip install magpylib, or --without-magpylib): {e}")
        };
        let input = self.child.stdin.as_mut().expect("piped");
        writeln!(input, "run").and_then(|()| input.flush()).map_err(|e| failed(&e))?;
        let mut line = Vec::new();
        // One byte at a time: what is read ahead would be lost with the reader.
        BufReader::with_capacity(1, self.child.stdout.as_mut().expect("piped"))
            .read_until(b'\n', &mut line)
            .map_err(|e| failed(&e))?;
        String::from_utf8_lossy(&line).trim().parse().map_err(|e| failed(&e))
    }
}

impl Drop for Magpylib {
    fn drop(&mut self) {
        // It ends with its input; if not, there is nothing to lose.
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}
