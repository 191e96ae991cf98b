// THE table of parameters of `bvh`: what is allowed, what it is for, and beside which others it means something.

#include "accel/bvh/bvh.h"

namespace raymeter {

namespace {

using Field = Param<BvhParams>;

bool by_sah(const BvhParams& p) { return p.builder != "goldsmith_salmon"; }
bool by_bins(const BvhParams& p) { return p.builder == "binned_sah" || p.builder == "sbvh"; }
bool by_insertion(const BvhParams& p) { return p.builder == "goldsmith_salmon"; }
bool by_random_insertion(const BvhParams& p) { return by_insertion(p) && (p.insertion_order == "shuffled" || p.insertion_order == "best"); }
bool by_best_insertion(const BvhParams& p) { return by_insertion(p) && p.insertion_order == "best"; }
bool by_spatial_splits(const BvhParams& p) { return p.builder == "sbvh"; }
bool by_clustering(const BvhParams& p) { return p.builder == "ploc"; }
bool by_wide_nodes(const BvhParams& p) { return p.is_wide(); }
bool in_packets_through_boxes(const BvhParams& p) { return p.traversal == "packet" && p.volume == "aabb"; }

bool takes_epsilon(const BvhParams& p) { return p.triangle_test == "pluecker" || (p.triangle_test == "moeller_trumbore" && p.precision == "float"); }

std::vector<Field> insertion_fields() {
  return {
      where(by_insertion, Field{"insertion_order",
                                &BvhParams::insertion_order,
                                "goldsmith_salmon: as in the scene, along its longest axis, at random, or the cheapest tree of `shuffles` random orders",
                                0,
                                0,
                                {"file", "sorted", "shuffled", "best"}}),
      where(by_random_insertion, Field{"insertion_seed", &BvhParams::insertion_seed, "goldsmith_salmon: of the first random order", 0, 1000000}),
      where(by_best_insertion, Field{"shuffles", &BvhParams::shuffles, "goldsmith_salmon: random orders tried by insertion_order=best", 1, 1000}),
      where(by_insertion, Field{"inherited", &BvhParams::inherited, "goldsmith_salmon: a place's cost includes the growth of the nodes above it"}),
      where(by_insertion, Field{"leaf_boxes", &BvhParams::leaf_boxes,
                                "goldsmith_salmon: primitives have boxes of their own; off: those under a node are tested once it is opened"}),
  };
}

std::vector<Field> weak_test_fields() {
  return {
      where(in_packets_through_boxes,
            Field{"box_test", &BvhParams::box_test, "padded misses nothing; the others may", 0, 0, {"padded", "unpadded", "fma"}, ParamUse::query}),
      where([](const BvhParams& p) { return in_packets_through_boxes(p) && p.box_test == "unpadded"; },
            Field{"box_padding",
                  &BvhParams::box_padding,
                  "unpadded: what its intervals grow by all the same, in ulp of their ends; padded has 10",
                  0,
                  65536,
                  {},
                  ParamUse::query}),
      where(in_packets_through_boxes, Field{"box_bounds",
                                            &BvhParams::box_bounds,
                                            "tight: boxes without the room that they have for what primitive tests err, so that box tests' own roundings show",
                                            0,
                                            0,
                                            {"padded", "tight"},
                                            ParamUse::query,
                                            nullptr,
                                            {{"padded"}}}),
      where(in_packets_through_boxes,
            Field{"reciprocal",
                  &BvhParams::reciprocal,
                  "box tests' 1 / direction: divided once a packet; the processor's estimate alone or after one of Newton's steps; none: "
                  "a division at every plane",
                  0,
                  0,
                  {"divide", "newton", "estimate", "none"},
                  ParamUse::query}),
      where(in_packets_through_boxes, Field{"triangle_test",
                                            &BvhParams::triangle_test,
                                            "woop_kahan is watertight and accurate; the others show what that costs; baldwin_weber: by maps made at build time",
                                            0,
                                            0,
                                            {"woop_kahan", "woop", "moeller_trumbore", "pluecker", "baldwin_weber"},
                                            ParamUse::query,
                                            nullptr,
                                            {{"woop_kahan", "woop", "moeller_trumbore", "pluecker"}}}),
      where([](const BvhParams& p) { return in_packets_through_boxes(p) && p.triangle_test == "moeller_trumbore"; },
            Field{"precision", &BvhParams::precision, "moeller_trumbore: of its arithmetic", 0, 0, {"float", "double"}, ParamUse::query}),
      where([](const BvhParams& p) { return in_packets_through_boxes(p) && takes_epsilon(p); },
            Field{"triangle_epsilon",
                  &BvhParams::triangle_epsilon,
                  "moeller_trumbore in float, pluecker: how far outside a triangle is still inside, in 2^-23 of the sum of its weights",
                  0,
                  65536,
                  {},
                  ParamUse::query}),
      where(in_packets_through_boxes, Field{"sphere_test",
                                            &BvhParams::sphere_test,
                                            "robust is accurate near, far and huge; the others show what that costs",
                                            0,
                                            0,
                                            {"robust", "naive", "haines"},
                                            ParamUse::query}),
  };
}

}  // namespace

std::vector<Field> BvhParams::fields() {
  std::vector<Field> fields{
      {"volume", &BvhParams::volume, "bounding volume of a node", 0, 0, {"aabb", "sphere", "obb", "kdop"}},
      {"builder", &BvhParams::builder, "how the hierarchy is built", 0, 0, bvh_builder_names()},
      {"traversal",
       &BvhParams::traversal,
       "how rays go through it; auto: in beams, in streams or alone, by how many rays a slice has and what they have in common, or in packets where a "
       "parameter needs them",
       0,
       0,
       {"packet", "heap", "beam", "stream", "single", "auto"},
       ParamUse::build,
       nullptr,
       {{"packet", "heap"}, {"beam", "stream", "single", "auto"}}},
      where([](const BvhParams& p) { return p.traversal == "beam" || p.traversal == "auto"; },
            Field{"group",
                  &BvhParams::group,
                  "beam, auto: rays that go down together in beams of 16, with packets of 16 rays and more; a multiple of 16",
                  16,
                  256,
                  {},
                  ParamUse::query}),
      where(
          [](const BvhParams& p) { return p.traversal == "stream" || p.traversal == "single"; },
          Field{
              "plane_bits",
              &BvhParams::plane_bits,
              "stream, single: bits of a plane of a node, in steps of the box around its children, rounded outwards: 2 to 8 in nodes of 128 bytes, 9 to 16 in "
              "192; 32: floats, 256",
              2,
              16,
              {},
              ParamUse::query,
              nullptr,
              {{"32"}},
              {kFloatPlanes}}),
      where(by_bins, Field{"bins", &BvhParams::bins, "binned_sah, sbvh: bins per axis, where a node has at least that many primitives", 2, 64}),
      where(
          [](const BvhParams& p) { return by_sah(p) || by_wide_nodes(p); },
          Field{"max_leaf_size", &BvhParams::max_leaf_size,
                "surface area heuristic: larger leaves are split even where that costs more; beam, stream, single, auto: but for leaves of triangles", 1, 64}),
      where(by_sah, Field{"node_cost", &BvhParams::node_cost, "surface area heuristic: cost of a node in primitive tests", 0.01, 100}),
  };
  const auto add = [&](const std::vector<Field>& more) { fields.insert(fields.end(), more.begin(), more.end()); };
  add(insertion_fields());
  add({
      where(by_spatial_splits, Field{"split_overlap", &BvhParams::split_overlap,
                                     "sbvh: planes are tried where children overlap by more than this share of the root's area", 0, 1}),
      where(by_spatial_splits,
            Field{"split_budget", &BvhParams::split_budget, "sbvh: most references beyond one a primitive, relative to the primitives", 0, 8}),
      where(by_clustering, Field{"ploc_radius", &BvhParams::ploc_radius, "ploc: how far away in the order a cluster looks for a partner", 1, 1000}),
      {"reinsertion", &BvhParams::reinsertion, "rounds in which subtrees of the binary tree are moved to better places", 0, 1000},
      where([](const BvhParams& p) { return !by_wide_nodes(p); },
            Field{"width", &BvhParams::width, "most children of a node, by opening nodes and grouping children; 0: as built", 0, 64}),
  });
  add(volume_fields<BvhParams>());
  add(weak_test_fields());
  return fields;
}

}  // namespace raymeter
