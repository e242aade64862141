//! Moments and expansions of the nodes, computed when first needed.

use glam::DVec3;
use magsplice_expansion::m2l::M2lInput;
use magsplice_expansion::moments::Moments;
use magsplice_expansion::multipole::MultipoleExpansion;
use magsplice_expansion::source::CuboidSource;

use super::blocks::TreeBlock;
use super::interaction::TranslatedNode;
use super::nodes::{NodeExpansion, Tree, TreeNode};
use crate::tolerances::LEAVES_PER_GROUP;

impl Tree {
    /// The multipole expansion of a node.
    pub(super) fn multipole_expansion(&self, node: usize) -> &MultipoleExpansion {
        &self.node_expansion(node).multipole
    }

    /// The moments and the expansion of a node.
    pub(super) fn node_expansion(&self, node: usize) -> &NodeExpansion {
        let of = &self.nodes[node];
        let Some(halves) = of.halves else {
            let [group, index] = [of.items.start / LEAVES_PER_GROUP, of.items.start % LEAVES_PER_GROUP];
            return &self.leaf_expansions[group].get_or_init(|| self.expansions_of_leaves(group))[index];
        };
        of.expansion.get_or_init(|| {
            if halves.iter().any(|&half| self.nodes[half].moment_degree < of.moment_degree) {
                let moments = Moments::from_sources(self.level, &self.sources(of), of.moment_degree);
                return NodeExpansion::new(of, moments);
            }
            let mut moments = Moments::new(of.moment_degree);
            for half in halves {
                let lower = &self.nodes[half];
                let own =
                    self.node_expansion(half).moments.truncated(of.moment_degree).rescaled(of.scale / lower.scale);
                moments.add(&own.translated((lower.centre - of.centre) * of.scale));
            }
            NodeExpansion::new(of, moments)
        })
    }

    fn expansions_of_leaves(&self, group: usize) -> Vec<NodeExpansion> {
        let items = group * LEAVES_PER_GROUP..self.items.len().min((group + 1) * LEAVES_PER_GROUP);
        let nodes: Vec<&TreeNode> = self.leaves[items].iter().map(|&leaf| &self.nodes[leaf]).collect();
        let sources: Vec<Vec<CuboidSource>> = nodes.iter().map(|node| self.sources(node)).collect();
        let groups: Vec<&[CuboidSource]> = sources.iter().map(|sources| &sources[..]).collect();
        let degree = nodes.iter().map(|node| node.moment_degree).max().unwrap_or(0);
        let moments = Moments::from_groups(self.level, &groups, degree);
        nodes
            .into_iter()
            .zip(moments)
            .map(|(node, moments)| NodeExpansion::new(node, moments.truncated(node.moment_degree)))
            .collect()
    }

    /// The blocks of a node relative to its centre, scaled.
    fn sources(&self, node: &TreeNode) -> Vec<CuboidSource> {
        let source = |block: &TreeBlock| {
            let (centre, size) = ((block.centre - node.centre) * node.scale, block.size * node.scale);
            CuboidSource::new(centre, size, self.rotations[block.frame].as_ref(), block.polarization_t)
        };
        self.blocks[node.blocks.clone()].iter().map(source).collect()
    }

    /// Input of the translation of a node to `centre`, where lengths are multiplied by `scale`.
    pub(super) fn m2l_input(&self, of: &TranslatedNode, centre: DVec3, scale: f64) -> M2lInput<'_> {
        let node = &self.nodes[of.node];
        M2lInput {
            moments: &self.node_expansion(of.node).moments,
            degree: of.degree,
            local_degree: of.local_degree,
            offset: (centre - node.centre) * node.scale,
            unit_ratio: scale / node.scale,
        }
    }
}
