//! Figures as PDF: the shapes of a figure, with text as outlines.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref};
use resvg::tiny_skia::{PathSegment, Pixmap, Transform};
use resvg::usvg::{Color, FillRule, Group, Image, ImageKind, LineCap, LineJoin, Node, Paint, Path, Tree};

use crate::error::DrawError;

const POINTS_PER_PX: f32 = 72.0 / 96.0;
const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const FIRST_IMAGE: i32 = 5;

/// What is drawn, and the images in it.
struct Drawn {
    content: Content,
    images: Vec<Pixmap>,
}

/// A file of one page of the size of the figure.
pub(crate) fn page(tree: &Tree) -> Result<Vec<u8>, DrawError> {
    let [width, height] = [tree.size().width(), tree.size().height()].map(|px| POINTS_PER_PX * px);
    let mut drawn = Drawn { content: Content::new(), images: Vec::new() };
    // From pixels with y downwards to points with y upwards.
    drawn.content.transform([POINTS_PER_PX, 0.0, 0.0, -POINTS_PER_PX, 0.0, height]);
    drawn.group(tree.root())?;
    let Drawn { content, images } = drawn;

    let mut file = Pdf::new();
    file.catalog(CATALOG).pages(PAGES);
    file.pages(PAGES).kids([PAGE]).count(1);
    let mut page = file.page(PAGE);
    page.media_box(Rect::new(0.0, 0.0, width, height)).parent(PAGES).contents(CONTENT);
    let (mut resources, numbers) = (page.resources(), 0..images.len());
    let mut named = resources.x_objects();
    for number in numbers {
        named.pair(Name(name(number).as_bytes()), reference(number));
    }
    named.finish();
    resources.finish();
    page.finish();
    for (number, image) in images.iter().enumerate() {
        let (pixels, _) = image.data().as_chunks::<4>();
        let colours: Vec<[u8; 3]> = pixels.iter().map(|[red, green, blue, _]| [*red, *green, *blue]).collect();
        let data = compressed(colours.as_flattened())?;
        let mut object = file.image_xobject(reference(number), &data);
        object.filter(Filter::FlateDecode);
        object.width(image.width() as i32).height(image.height() as i32).bits_per_component(8);
        object.color_space().device_rgb();
    }
    file.stream(CONTENT, &compressed(&content.finish())?).filter(Filter::FlateDecode);
    Ok(file.finish())
}

fn name(image: usize) -> String {
    format!("I{image}")
}

fn reference(image: usize) -> Ref {
    Ref::new(FIRST_IMAGE + image as i32)
}

fn compressed(data: &[u8]) -> Result<Vec<u8>, DrawError> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(data)?;
    Ok(encoder.finish()?)
}

impl Drawn {
    fn group(&mut self, group: &Group) -> Result<(), DrawError> {
        // No figure has any; a page without them would be wrong without a word.
        if group.opacity().get() < 1.0 || group.mask().is_some() || !group.filters().is_empty() {
            return Err("it has transparency, which its PDF lacks".into());
        }
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group)?,
                Node::Path(path) => self.path(path)?,
                Node::Image(image) => self.image(image)?,
                Node::Text(text) => self.group(text.flattened())?,
            }
        }
        Ok(())
    }

    fn transform(&mut self, Transform { sx, kx, ky, sy, tx, ty }: Transform) {
        self.content.transform([sx, ky, kx, sy, tx, ty]);
    }

    fn path(&mut self, path: &Path) -> Result<(), DrawError> {
        if !path.is_visible() {
            return Ok(());
        }
        self.content.save_state();
        self.transform(path.abs_transform());
        if let Some(fill) = path.fill() {
            let [red, green, blue] = colour(fill.paint())?;
            self.content.set_fill_rgb(red, green, blue);
            self.outline(path);
            match fill.rule() {
                FillRule::NonZero => self.content.fill_nonzero(),
                FillRule::EvenOdd => self.content.fill_even_odd(),
            };
        }
        if let Some(stroke) = path.stroke() {
            let [red, green, blue] = colour(stroke.paint())?;
            self.content.set_stroke_rgb(red, green, blue).set_line_width(stroke.width().get());
            self.content.set_miter_limit(stroke.miterlimit().get());
            self.content.set_line_cap(match stroke.linecap() {
                LineCap::Butt => LineCapStyle::ButtCap,
                LineCap::Round => LineCapStyle::RoundCap,
                LineCap::Square => LineCapStyle::ProjectingSquareCap,
            });
            self.content.set_line_join(match stroke.linejoin() {
                LineJoin::Round => LineJoinStyle::RoundJoin,
                LineJoin::Bevel => LineJoinStyle::BevelJoin,
                _ => LineJoinStyle::MiterJoin,
            });
            if let Some(dashes) = stroke.dasharray() {
                self.content.set_dash_pattern(dashes.iter().copied(), stroke.dashoffset());
            }
            self.outline(path);
            self.content.stroke();
        }
        self.content.restore_state();
        Ok(())
    }

    /// Adds the lines and curves of a path.
    fn outline(&mut self, path: &Path) {
        let mut at = [0.0; 2];
        for segment in path.data().segments() {
            match segment {
                PathSegment::MoveTo(p) => {
                    self.content.move_to(p.x, p.y);
                    at = [p.x, p.y];
                }
                PathSegment::LineTo(p) => {
                    self.content.line_to(p.x, p.y);
                    at = [p.x, p.y];
                }
                PathSegment::QuadTo(q, p) => {
                    // The cubic curve that is the same.
                    let third = |end: [f32; 2]| [end[0] + (q.x - end[0]) / 1.5, end[1] + (q.y - end[1]) / 1.5];
                    let ([ax, ay], [bx, by]) = (third(at), third([p.x, p.y]));
                    self.content.cubic_to(ax, ay, bx, by, p.x, p.y);
                    at = [p.x, p.y];
                }
                PathSegment::CubicTo(a, b, p) => {
                    self.content.cubic_to(a.x, a.y, b.x, b.y, p.x, p.y);
                    at = [p.x, p.y];
                }
                PathSegment::Close => {
                    self.content.close_path();
                }
            }
        }
    }

    fn image(&mut self, image: &Image) -> Result<(), DrawError> {
        let ImageKind::PNG(data) = image.kind() else { return Err("it has an image that is no PNG".into()) };
        let pixels = Pixmap::decode_png(data)?;
        let [width, height] = [image.size().width(), image.size().height()];
        self.content.save_state();
        self.transform(image.abs_transform());
        // An image has its first row at the top of a square with y upwards.
        self.content.transform([width, 0.0, 0.0, -height, 0.0, height]);
        self.content.x_object(Name(name(self.images.len()).as_bytes()));
        self.content.restore_state();
        self.images.push(pixels);
        Ok(())
    }
}

fn colour(paint: &Paint) -> Result<[f32; 3], DrawError> {
    let Paint::Color(Color { red, green, blue }) = paint else { return Err("it has a gradient or a pattern".into()) };
    Ok([red, green, blue].map(|part| f32::from(*part) / 255.0))
}
