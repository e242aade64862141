//! A layout that is edited and evaluated.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use magsplice::Film;
use magsplice::decouple::Figures;
use magsplice::design::{DesignProblem, ProgressUpdate, SearchStage};
use magsplice::layout::{Brief, Goal, Layout, TileForm, Under, edited_text};
use magsplice::magnet::overlaps;
use magsplice::prelude::{DVec3, Tile};
use magsplice::tolerance::{Statistics, statistics};
use serde::Serialize;
use serde_json::Value;

use crate::evaluated::{Evaluated, Mapped};
use crate::keep::text_with_tiles;
use crate::readable_files::ReadableFiles;
use crate::request::{Request, TileEdit};
use crate::state::State;

/// Observes long requests. It receives JSON, and stops the work with [`ControlFlow::Break`].
pub type Observer<'o> = &'o mut (dyn FnMut(&str) -> ControlFlow<()> + Send);

/// The layout of a page.
#[derive(Debug, Default)]
pub struct Session {
    open: Option<OpenLayout>,
    files: ReadableFiles,
}

#[derive(Debug)]
struct OpenLayout {
    name: String,
    text: String,
    files: ReadableFiles,
    /// The layout of the text, with the tiles of later edits.
    layout: Layout,
    /// The film of the layout, if it was evaluated, and whether it is rigid.
    film: Option<(bool, Film)>,
    /// The samples of films as made so far, and their seed.
    made: Option<(u64, Vec<Figures>)>,
}

/// Two tiles that overlap.
#[derive(Serialize)]
struct OverlappingPair {
    tiles: [usize; 2],
    depth_mm: f64,
}

/// Samples of films as made.
#[derive(Serialize)]
struct Made {
    samples: usize,
    /// Statistics of the figures.
    #[serde(flatten)]
    figures: Figures<Statistics>,
    /// Statistics of the displacement RMSE along all axes together, in millimetres.
    displacement_mm: Statistics,
    /// The displacement RMSE along all axes together of each sample, in millimetres.
    displacements_mm: Vec<f64>,
}

/// A film that a search found.
#[derive(Serialize)]
struct Improved {
    state: State,
    /// The error of the goal before and after.
    before: Option<f64>,
    after: Option<f64>,
    /// Whether the search ended by itself.
    is_finished: bool,
}

impl Session {
    /// A session where there are no files: its layouts may refer to baselines.
    pub fn of_module() -> Session {
        Session { open: None, files: ReadableFiles::any() }
    }

    /// Lets later requests read these files beside the layout. A new session reads none.
    pub fn allow(&mut self, files: ReadableFiles) {
        if let Some(open) = &mut self.open {
            open.files = files.clone();
        }
        self.files = files;
    }

    /// The answer to a request, both as JSON.
    pub fn answer(&mut self, request: &[u8]) -> String {
        self.answer_reporting(request, &mut |_| ControlFlow::Continue(()))
    }

    /// The answer to a request, whose work is observed.
    pub fn answer_reporting(&mut self, request: &[u8], observer: Observer) -> String {
        let answered = serde_json::from_slice(request).map_err(|error| error.to_string());
        let answered = answered.and_then(|request| self.evaluated(request, observer));
        match answered {
            Ok(value) => format!("{{\"ok\":{value}}}"),
            Err(error) => format!("{{\"error\":{}}}", Value::from(error)),
        }
    }

    fn evaluated(&mut self, request: Request, observer: Observer) -> Result<String, String> {
        if let Request::Open { text, name } = request {
            let files = self.files.clone();
            let layout = files.layout(&text, &name)?;
            let open = self.open.insert(OpenLayout { name, text, files, layout, film: None, made: None });
            return json(&open.state());
        }
        let open = self.open.as_mut().ok_or("no layout is open")?;
        match request {
            Request::Open { .. } => unreachable!("answered above"),
            Request::Set { edits } => {
                let text = edited_text(&open.text, &edits).map_err(|error| error.to_string())?;
                open.replace(text)?;
                json(&open.state())
            }
            Request::Edit { tiles } => json(&open.edit(&tiles)?),
            Request::Keep => {
                let read = |text: &str| open.files.layout(text, &open.name);
                let text = text_with_tiles(&open.layout, &open.text, open.files.folder(), read)?;
                open.replace(text)?;
                json(&open.state())
            }
            Request::Evaluate { rigid } => json(&Evaluated::of(open.film(rigid)?).map_err(|error| error.to_string())?),
            Request::Map { quantity, axis, z_mm, counts, rigid } => {
                json(&Mapped::of(open.film(rigid)?, quantity, axis, z_mm, counts)?)
            }
            Request::Budget { samples } => {
                json(&open.film(false)?.budget(1, samples.max(1)).map_err(|error| error.to_string())?)
            }
            Request::Made { add, seed } => json(&open.made(add, seed)?),
            Request::Improve { steps } => json(&open.improve(steps, observer)?),
        }
    }
}

impl OpenLayout {
    fn state(&self) -> State {
        State::of(&self.layout, &self.text)
    }

    fn replace(&mut self, text: String) -> Result<(), String> {
        let layout = self.files.layout(&text, &self.name)?;
        (self.text, self.layout, self.film, self.made) = (text, layout, None, None);
        Ok(())
    }

    /// The prepared film.
    fn film(&mut self, rigid: bool) -> Result<&Film, String> {
        let rigid = rigid || !self.layout.has_recoil();
        if self.film.as_ref().is_none_or(|(known, _)| *known != rigid) {
            let mut layout = self.layout.clone();
            layout.expectations.made = None;
            let film =
                if rigid { Film::rigid(layout) } else { Film::new(layout).map_err(|error| error.to_string())? };
            self.film = Some((rigid, film));
        }
        self.film.as_ref().map(|(_, film)| film).ok_or_else(|| "no film".to_owned())
    }

    /// Changes all of the tiles, or none if one cannot exist.
    fn edit(&mut self, edits: &[TileEdit]) -> Result<Vec<OverlappingPair>, String> {
        let layout = &mut self.layout;
        let changed = |edit: &TileEdit| {
            let named = layout.tiles.get(edit.tile).ok_or_else(|| format!("there is no tile {}", edit.tile))?;
            let (tile, given) = (&named.tile, |new: Option<DVec3>, old| new.unwrap_or(old));
            let position = given(edit.position_mm, tile.position());
            let (size, j_t) = (given(edit.size_mm, tile.size()), given(edit.polarization_t, tile.polarization_t()));
            let changed = Tile::new(position, size, j_t).and_then(|new| new.rotated(tile.rotation()));
            changed.map(|changed| (edit.tile, changed)).map_err(|faults| format!("tile \"{}\": {faults}", named.name))
        };
        let changed = edits.iter().map(changed).collect::<Result<Vec<(usize, Tile)>, String>>()?;
        changed.into_iter().for_each(|(tile, changed)| layout.tiles[tile].tile = changed);
        (self.film, self.made) = (None, None);
        let bare = self.layout.bare_tiles();
        let pairs = overlaps(&bare).filter(|pair| pair.depth > self.layout.overlap_mm);
        Ok(pairs.map(|pair| OverlappingPair { tiles: [pair.first, pair.second], depth_mm: pair.depth }).collect())
    }

    fn made(&mut self, add: u64, seed: u64) -> Result<Made, String> {
        let known = self.made.take().filter(|(known, _)| *known == seed);
        let mut samples = known.map(|(_, samples)| samples).unwrap_or_default();
        let film = Film::new(self.layout.clone()).map_err(|error| error.to_string())?;
        let sampling = film.sampling().map_err(|error| error.to_string())?;
        let first = samples.len() as u64;
        let sampler = sampling.sampler(seed).map_err(|error| error.to_string())?;
        let added = sampler.errors_of_range(first..first + add.max(1), || {});
        samples.extend(added.map_err(|(sample, error)| format!("sample {sample}: {error}"))?);
        let displacements_mm: Vec<f64> =
            samples.iter().map(|of| DVec3::from(of.displacement_rmse_mm).length()).collect();
        let none = || "a sample has no errors of the displacement".to_owned();
        let made = Made {
            samples: samples.len(),
            figures: statistics(&samples).ok_or_else(none)?,
            displacement_mm: Statistics::new(displacements_mm.iter().copied()).ok_or_else(none)?,
            displacements_mm,
        };
        self.made = Some((seed, samples));
        Ok(made)
    }

    fn improve(&mut self, steps: usize, observer: Observer) -> Result<Improved, String> {
        let mut layout = self.layout.clone();
        // From this film alone: several starts would end at another step on each machine.
        if let Some(brief) = &mut layout.brief {
            brief.starts = 1;
        }
        let problem = DesignProblem::new(&layout).map_err(|error| error.to_string())?;
        let (seen, errors, observer) = (AtomicUsize::new(0), Mutex::new(Vec::new()), Mutex::new(observer));
        let stopped = |update: ProgressUpdate| {
            if let (Some(best), SearchStage::Starts) = (update.best, update.stage) {
                errors.lock().expect("no panic holds it").push(best);
                let told = format!("{{\"best\":{best}}}");
                if (observer.lock().expect("no panic holds it"))(&told).is_break() {
                    return ControlFlow::Break(());
                }
            }
            match seen.fetch_add(1, Ordering::Relaxed) >= steps {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let found = problem.search(&stopped).map_err(|error| error.to_string())?;
        let is_finished = !found.interrupted;
        let errors = errors.into_inner().expect("no panic holds it");
        let [before, after] = [&found.before, &found.after].map(|of| goal_error(&of.figures, layout.brief.as_ref()?));
        // The tiles and the spacing alone: bounds, texts and the history stay the user's.
        let Layout { tiles, .. } = problem.designed_layout(&found, &self.name);
        let spaced = found.spacing_mm.and_then(|spacing_mm| self.layout.with_head_spacing(spacing_mm));
        let improved = Layout { tiles, ..spaced.unwrap_or_else(|| self.layout.clone()) };
        let is_same = improved.tiles == self.layout.tiles;
        if !is_same || improved.head_spacing_mm() != self.layout.head_spacing_mm() {
            let text = improved.to_edited_toml(TileForm::Compact, self.files.folder(), &self.name);
            self.replace(text.map_err(|error| error.to_string())?)?;
        }
        Ok(Improved {
            state: self.state(),
            before: before.or(errors.first().copied()),
            after: after.or(errors.last().copied()),
            is_finished,
        })
    }
}

/// The root of the weighted sum of squares of the errors that a brief counts, of the film as drawn.
/// `None` for other goals.
fn goal_error(figures: &Figures, brief: &Brief) -> Option<f64> {
    let errors = match (brief.under, brief.goal) {
        (Under::Nominal, Goal::Displacement) => figures.displacement_rmse_mm.to_array(),
        (Under::Nominal, Goal::Uniformity) => figures.uniformity_rmse.map(|rmse| rmse.unwrap_or(0.0)).to_array(),
        _ => return None,
    };
    Some(errors.iter().zip(brief.weights).map(|(error, weight)| weight * error * error).sum::<f64>().sqrt())
}

fn json(value: &impl Serialize) -> Result<String, String> {
    serde_json::to_string(value).map_err(|error| error.to_string())
}
