//! A tree over all tiles of a scene: neighbours together, with an expansion of their field outside a sphere around them (docs/physics.md, section 5.2).

use std::f64::consts::PI;
use std::ops::Range as Span;
use std::sync::OnceLock;

use fearless_simd::Level;
use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};
use magsplice_cuboid::tolerances::{CLOSED_FORM_COST, LARGEST_FIELD_OVER_J, SINGLE_TILE_COST};
use magsplice_expansion::m2l::M2lInput;
use magsplice_expansion::moments::Moments;
use magsplice_expansion::multipole::MultipoleExpansion;
use magsplice_expansion::source::CuboidSource;
use magsplice_expansion::tolerances::HIGHEST_DEGREE;
use magsplice_magnet::{BoundingBox, Tile};
use magsplice_simd::power_of_two::power_of_two_reciprocal;

use super::interaction::TranslatedNode;
use crate::direct::direct_sum::DirectSum;
use crate::prepare::clusters::Cluster;
use crate::prepare::frames::{Frame, Frames};
use crate::tolerances::{FLAT_NODE_COST, ITEMS_EXPANDED, NODE_COST};

/// Nodes above each other, the first of them all tiles.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    level: Level,
    /// From each frame to the scene.
    pub(super) rotations: Vec<Option<DMat3>>,
    /// Those of each item one after the other.
    pub(super) bodies: Vec<Body>,
    /// The largest |J|, in tesla.
    largest_j_t: f64,
    pub(super) items: Vec<Item>,
    pub(super) nodes: Vec<Node>,
    /// The nodes that are one item, by item.
    leaves: Vec<usize>,
    /// What these are outside, so many items together; made when one of them is first needed.
    outside_leaves: Vec<OnceLock<Vec<Outside>>>,
}

/// A block in the scene's frame.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) centre: DVec3,
    size: DVec3,
    pub(super) frame: usize,
    polarization_t: DVec3,
    pub(super) half_diagonal: f64,
}

/// What the exact field takes together: tiles that share corners, or one by itself.
#[derive(Clone, Debug)]
pub(super) struct Item {
    /// Index of its frame.
    pub(super) frame: usize,
    source: ClusterSource,
    bodies: Span<usize>,
}

/// Where the forms of an item are.
#[derive(Clone, Debug)]
enum ClusterSource {
    /// At this index of the frame's table.
    InTable(usize),
    /// Here, as it is a half of what is in the table.
    Half {
        blocks: Span<usize>,
        /// Made when first needed.
        made: OnceLock<Box<Cluster>>,
    },
}

/// Items next to each other.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) items: Span<usize>,
    pub(super) bodies: Span<usize>,
    pub(super) centre: DVec3,
    /// Of a sphere around all of it.
    pub(super) radius: f64,
    /// A box around all of it.
    bounds: BoundingBox,
    /// A power of two that takes the radius to order one.
    pub(super) scale: f64,
    /// The sum of |J| V / 4 pi, scaled.
    strength_t: f64,
    /// The highest degree that costs less than its tiles one by one.
    pub(super) degree: usize,
    /// That of twice as many tiles, up to which its moments are known: those of the node above it come from them.
    known_degree: usize,
    /// The two halves.
    pub(super) halves: Option<[usize; 2]>,
    /// The sum over tiles of |J| V / 4 pi times the mean of distance^degree from the centre, at most; scaled. Found when first needed.
    pub(super) reach_t: OnceLock<f64>,
    /// Made when first needed, if it has halves.
    outside: OnceLock<Outside>,
}

/// The field of a node outside its sphere.
#[derive(Clone, Debug)]
pub(super) struct Outside {
    moments: Moments,
    expansion: MultipoleExpansion,
    /// At most the field of each degree at distance 1, scaled.
    pub(super) powers: Vec<f64>,
    /// The same over the root of a degree and one.
    pub(super) means: Vec<f64>,
}

impl Tree {
    /// Of the tiles arranged, with expansions up to `degree` where they pay.
    pub(crate) fn new(direct: &DirectSum, degree: usize) -> Tree {
        Tree::from_frames(direct.level(), direct.frames(), direct.tiles(), degree)
    }

    fn from_frames(level: Level, prepared: &Frames, tiles: &[Tile], degree: usize) -> Tree {
        let mut unsorted: Vec<Option<(Vec<Body>, usize, ClusterSource)>> = Vec::new();
        for (index, frame) in prepared.frames().iter().enumerate() {
            for (blocks, source) in items_of(frame) {
                let bodies = blocks.map(|block| {
                    let block = &frame.blocks[block];
                    let size = DVec3::from(block.size);
                    Body {
                        centre: prepared.centre_in_scene(frame, block, &tiles[block.tile]),
                        size,
                        frame: index,
                        polarization_t: frame.to_scene.vector(block.polarization_t),
                        half_diagonal: 0.5 * size.length(),
                    }
                });
                unsorted.push(Some((bodies.collect(), index, source)));
            }
        }
        let centres: Vec<DVec3> = unsorted.iter().flatten().map(|(bodies, ..)| around(bodies).centre()).collect();
        let mut order: Vec<usize> = (0..unsorted.len()).collect();
        let rotations = prepared.frames().iter().map(|frame| frame.to_scene.rotation().copied()).collect();
        let largest_j_t = tiles.iter().map(|tile| tile.polarization_t().length()).fold(0.0, f64::max);
        let mut tree = Tree {
            level,
            rotations,
            bodies: Vec::new(),
            largest_j_t,
            items: Vec::new(),
            nodes: Vec::new(),
            leaves: Vec::new(),
            outside_leaves: Vec::new(),
        };
        let mut halves = Vec::new();
        if !order.is_empty() {
            bisect(&centres, &mut order, 0, &mut halves);
        }
        for index in order {
            let (bodies, frame, source) = unsorted[index].take().expect("each once");
            let start = tree.bodies.len();
            tree.bodies.extend(bodies);
            tree.items.push(Item { frame, source, bodies: start..tree.bodies.len() });
        }
        for (items, halves) in halves {
            tree.add_node(items, halves, degree);
        }
        tree.outside_leaves.resize_with(tree.items.len().div_ceil(ITEMS_EXPANDED), OnceLock::new);
        tree
    }

    fn add_node(&mut self, items: Span<usize>, halves: Option<[usize; 2]>, degree: usize) {
        let span = self.items[items.start].bodies.start..self.items[items.end - 1].bodies.end;
        let bodies = &self.bodies[span.clone()];
        let centre = middle_of(bodies);
        let radius = bodies.iter().map(|b| (b.centre - centre).length() + b.half_diagonal).fold(0.0, f64::max);
        let scale = power_of_two_reciprocal(radius);
        let strength_t = bodies.iter().map(|body| body.strength_t(scale)).sum();
        let cost: f64 = self.items[items.clone()].iter().map(Item::cost).sum();
        let node_cost = if self.is_flat(bodies) { FLAT_NODE_COST } else { NODE_COST };
        let highest = |cost: f64| {
            let pays = |degree: &usize| node_cost * ((degree + 2) * (degree + 3)) as f64 <= cost;
            (1..=degree.min(HIGHEST_DEGREE)).take_while(pays).last().unwrap_or(1)
        };
        if halves.is_none() {
            debug_assert_eq!(self.leaves.len(), items.start, "leaves come in the order of their items");
            self.leaves.push(self.nodes.len());
        }
        self.nodes.push(Node {
            items,
            bodies: span,
            centre,
            radius,
            bounds: around(bodies),
            scale,
            strength_t,
            degree: highest(cost),
            known_degree: highest(2.0 * cost),
            halves,
            reach_t: OnceLock::new(),
            outside: OnceLock::new(),
        });
    }

    /// Whether the moments have a [parity](magsplice_expansion::moments::Parity): tiles in one plane, not tilted, with J in it or across.
    fn is_flat(&self, bodies: &[Body]) -> bool {
        let upright = |body: &Body| self.rotations[body.frame].is_none_or(|turn| turn.z_axis.xy() == DVec2::ZERO);
        let level = |body: &Body| body.centre.z == bodies[0].centre.z;
        let j_t = |body: &Body| body.polarization_t;
        bodies.iter().all(|body| level(body) && upright(body))
            && (bodies.iter().all(|body| j_t(body).z == 0.0) || bodies.iter().all(|body| j_t(body).xy() == DVec2::ZERO))
    }

    /// A node's expansion to be translated to `middle`, where lengths are multiplied by `scale`.
    pub(super) fn m2l_input(&self, of: &TranslatedNode, middle: DVec3, scale: f64) -> M2lInput<'_> {
        let node = &self.nodes[of.node];
        M2lInput {
            moments: &self.outside(of.node).moments,
            degree: of.degree,
            local_degree: of.local_degree,
            offset: (middle - node.centre) * node.scale,
            unit_ratio: scale / node.scale,
        }
    }

    /// At most the sum over a node's tiles of the magnitudes of their fields in a box outside its sphere or its box, in tesla; without bound in both.
    pub(super) fn node_field_bound_t(&self, node: usize, points: &BoundingBox) -> f64 {
        let of = &self.nodes[node];
        let gap = (of.distance(points) - of.radius * of.scale).max(points.gap(&of.bounds).length() * of.scale);
        2.0 * 3.0_f64.sqrt() * of.strength_t / gap.powi(3)
    }

    /// The same of the node of an item, anywhere; not found more closely than to `enough_t`.
    pub(super) fn item_field_bound_t(&self, node: usize, points: &BoundingBox, enough_t: f64) -> f64 {
        let item = self.nodes[node].items.start;
        let outside_t = self.node_field_bound_t(node, points);
        if outside_t <= enough_t {
            return outside_t;
        }
        let most = |body: &Body| {
            let gap = (points.gap(&BoundingBox { lower: body.centre, upper: body.centre }).length()
                - body.half_diagonal)
                .max(0.0);
            let dipoles = (body.size / gap).element_product() / (2.0 * PI);
            body.polarization_t.length() * 3.0_f64.sqrt() * dipoles.min(LARGEST_FIELD_OVER_J)
        };
        self.bodies[self.items[item].bodies.clone()].iter().map(most).sum()
    }

    /// How many tiles an item has.
    pub(super) fn tiles_of_item(&self, item: usize) -> usize {
        self.items[item].bodies.len()
    }

    /// How many tiles a node has.
    pub(super) fn tiles_of_node(&self, node: usize) -> usize {
        self.nodes[node].bodies.len()
    }

    /// The largest |J|, in tesla.
    pub(crate) fn largest_j_t(&self) -> f64 {
        self.largest_j_t
    }

    pub(super) fn expansion(&self, node: usize) -> &MultipoleExpansion {
        &self.outside(node).expansion
    }

    pub(super) fn outside(&self, node: usize) -> &Outside {
        let of = &self.nodes[node];
        let Some(halves) = of.halves else {
            let [group, place] = [of.items.start / ITEMS_EXPANDED, of.items.start % ITEMS_EXPANDED];
            return &self.outside_leaves[group].get_or_init(|| self.outside_of_leaves(group))[place];
        };
        of.outside.get_or_init(|| {
            if halves.iter().any(|&half| self.nodes[half].known_degree < of.known_degree) {
                return Outside::new(of, Moments::from_sources(self.level, &self.sources(of), of.known_degree));
            }
            let mut moments = Moments::new(of.known_degree);
            for half in halves {
                let lower = &self.nodes[half];
                let own = self.outside(half).moments.truncated(of.known_degree).rescaled(of.scale / lower.scale);
                moments.add(&own.translated((lower.centre - of.centre) * of.scale));
            }
            Outside::new(of, moments)
        })
    }

    fn outside_of_leaves(&self, group: usize) -> Vec<Outside> {
        let items = group * ITEMS_EXPANDED..self.items.len().min((group + 1) * ITEMS_EXPANDED);
        let nodes: Vec<&Node> = self.leaves[items].iter().map(|&leaf| &self.nodes[leaf]).collect();
        let sources: Vec<Vec<CuboidSource>> = nodes.iter().map(|node| self.sources(node)).collect();
        let groups: Vec<&[CuboidSource]> = sources.iter().map(|sources| &sources[..]).collect();
        let degree = nodes.iter().map(|node| node.known_degree).max().unwrap_or(0);
        let moments = Moments::from_groups(self.level, &groups, degree);
        nodes
            .into_iter()
            .zip(moments)
            .map(|(node, moments)| Outside::new(node, moments.truncated(node.known_degree)))
            .collect()
    }

    fn sources(&self, node: &Node) -> Vec<CuboidSource> {
        let source = |body: &Body| {
            let (centre, size) = ((body.centre - node.centre) * node.scale, body.size * node.scale);
            CuboidSource::new(centre, size, self.rotations[body.frame].as_ref(), body.polarization_t)
        };
        self.bodies[node.bodies.clone()].iter().map(source).collect()
    }
}

impl Outside {
    fn new(node: &Node, moments: Moments) -> Outside {
        let powers = moments.field_bounds();
        Outside {
            expansion: MultipoleExpansion::from_moments(&moments, node.centre.to_array(), node.scale),
            means: powers.iter().enumerate().map(|(l, power)| power / (l as f64 + 1.0).sqrt()).collect(),
            powers,
            moments,
        }
    }
}

impl Item {
    /// The forms that serve it.
    pub(super) fn cluster<'a>(&'a self, frame: &'a Frame) -> &'a Cluster {
        match &self.source {
            ClusterSource::InTable(index) => &frame.clusters.clusters[*index],
            ClusterSource::Half { blocks, made } => {
                made.get_or_init(|| Box::new(Cluster::half(&frame.blocks, blocks.clone())))
            }
        }
    }

    /// What the closed form takes at a vector of points, in multiply-adds.
    fn cost(&self) -> f64 {
        if self.bodies.len() == 1 { SINGLE_TILE_COST } else { CLOSED_FORM_COST * self.bodies.len() as f64 }
    }
}

impl Node {
    /// From its centre to the nearest of the points, scaled.
    pub(super) fn distance(&self, points: &BoundingBox) -> f64 {
        points.gap(&BoundingBox { lower: self.centre, upper: self.centre }).length() * self.scale
    }
}

impl Body {
    /// |J| V / 4 pi, lengths scaled.
    pub(super) fn strength_t(&self, scale: f64) -> f64 {
        self.polarization_t.length() * (self.size * scale).element_product() / (4.0 * PI)
    }

    /// At most the mean over it of distance^power from a centre, lengths scaled: |x|^power is convex, so its mean is at most that of the corners.
    pub(super) fn mean_power(&self, rotation: Option<&DMat3>, centre: DVec3, scale: f64, power: i32) -> f64 {
        let half = 0.5 * self.size;
        let along = |axis: DVec3| rotation.map_or(axis, |rotation| *rotation * axis);
        let (x, y, z) = (along(DVec3::X * half.x), along(DVec3::Y * half.y), along(DVec3::Z * half.z));
        let middle = self.centre - centre;
        let corners = [x + y + z, x + y - z, x - y + z, x - y - z].map(|corner| {
            [middle + corner, middle - corner].map(|from| (from.length() * scale).powi(power)).iter().sum::<f64>()
        });
        corners.iter().sum::<f64>() / 8.0
    }
}

/// What is together in a frame's table, or its halves.
fn items_of(frame: &Frame) -> impl Iterator<Item = (Span<usize>, ClusterSource)> {
    frame.clusters.clusters.iter().enumerate().flat_map(|(index, of)| match of.halves(&frame.blocks) {
        Some(halves) => halves
            .map(|blocks| (blocks.clone(), ClusterSource::Half { blocks, made: OnceLock::new() }))
            .into_iter()
            .collect(),
        None => vec![(of.blocks.clone(), ClusterSource::InTable(index))],
    })
}

/// That of the box around them; along an axis on which all have the same, exactly that, so that what vanishes by symmetry vanishes to the last digit.
fn middle_of(bodies: &[Body]) -> DVec3 {
    let (first, middle) = (bodies[0].centre, around(bodies).centre());
    let level = |axis: usize| bodies.iter().all(|body| body.centre[axis] == first[axis]);
    DVec3::from([0, 1, 2].map(|axis: usize| if level(axis) { first[axis] } else { middle[axis] }))
}

fn around(bodies: &[Body]) -> BoundingBox {
    let lower = bodies.iter().map(|b| b.centre - b.half_diagonal).fold(DVec3::INFINITY, DVec3::min);
    let upper = bodies.iter().map(|b| b.centre + b.half_diagonal).fold(DVec3::NEG_INFINITY, DVec3::max);
    BoundingBox { lower, upper }
}

/// Halves of halves of what `order` names, across the axis along which the centres reach farthest: stretches of the new order, each before its halves.
fn bisect(
    centres: &[DVec3],
    order: &mut [usize],
    start: usize,
    stretches: &mut Vec<(Span<usize>, Option<[usize; 2]>)>,
) -> usize {
    let own = stretches.len();
    stretches.push((start..start + order.len(), None));
    if order.len() > 1 {
        let lower = order.iter().map(|&i| centres[i]).fold(DVec3::INFINITY, DVec3::min);
        let upper = order.iter().map(|&i| centres[i]).fold(DVec3::NEG_INFINITY, DVec3::max);
        let axis = (upper - lower).max_position();
        let middle = order.len() / 2;
        let along = |index: usize| centres[index][axis];
        order.select_nth_unstable_by(middle, |&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
        let (low, high) = order.split_at_mut(middle);
        let halves = [bisect(centres, low, start, stretches), bisect(centres, high, start + middle, stretches)];
        stretches[own].1 = Some(halves);
    }
    own
}
