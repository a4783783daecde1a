// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/volume.h"

#include "parts/base/disjoint_sets.h"
#include "parts/base/error.h"
#include "parts/base/memory.h"
#include "parts/cut/rasterize.h"
#include "parts/mesh/edges.h"

namespace parts::cut {
namespace {

bool any(const std::vector<char>& flags) { return std::find(flags.begin(), flags.end(), 1) != flags.end(); }

double area(const Mesh& m, int f) {
  return 0.5 * (m.corner(f, 1) - m.corner(f, 0)).cross(m.corner(f, 2) - m.corner(f, 0)).norm();
}

/// Edge-connected pieces of the faces that are not wholly inside the volume,
/// appended to voxels.outer.
void add_outer_pieces(Model& model, bool of_a, const Box& volume, JointVoxels& voxels) {
  const Mesh& mesh = model.prepared.mesh;
  model.piece.assign(mesh.faces.size(), -1);
  std::vector<char> outer(mesh.faces.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f) outer[f] = !volume.contains(mesh.face_box(f));
  if (!any(outer)) return;
  DisjointSets sets(mesh.face_count());
  mesh::for_each_mesh_edge(mesh::sorted_half_edges(mesh), [&](auto first, auto last) {
    for (auto e = first + 1; e < last; ++e)
      if (outer[first->face] && outer[e->face]) sets.unite(first->face, e->face);
  });
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (!outer[f]) continue;
    const int root = sets.find(f);
    if (root == f) model.piece[f] = int(voxels.outer.size()), voxels.outer.push_back({of_a, false, {}});
    model.piece[f] = model.piece[root];
    OuterPiece& piece = voxels.outer[model.piece[f]];
    piece.keep |= model.keep[f] != 0;
    for_each_voxel(voxels.grid, mesh, f, [&](std::size_t v) { piece.voxels.push_back(v); });
  }
  for (OuterPiece& piece : voxels.outer) {
    std::sort(piece.voxels.begin(), piece.voxels.end());
    piece.voxels.erase(std::unique(piece.voxels.begin(), piece.voxels.end()), piece.voxels.end());
  }
}

/// About how many bytes a grid over the volume takes: a dozen bit sets, and
/// what the graph holds a surface voxel.
double memory_estimate(const Model& a, const Model& b, const Grid& grid) {
  const Box box = grid.box();
  const double most = box.diagonal().squaredNorm();  // of a face's area, within the grid
  double surface = 0;
  for (const Model* m : {&a, &b})
    for (int f = 0; f < m->prepared.mesh.face_count(); ++f)
      if (box.intersects(m->prepared.mesh.face_box(f))) surface += std::min(area(m->prepared.mesh, f), most);
  const double cells = double(grid.dims[0]) * grid.dims[1] * grid.dims[2];
  return 2.5 * cells + 600.0 * std::min(cells, 2.5 * surface / (grid.size * grid.size));
}

}  // namespace

bool fits_memory(const Model& a, const Model& b, const Box& volume, int resolution) {
  const Grid grid = Grid::over(volume, resolution);
  const std::optional<double> have = available_memory();
  const double cells = double(grid.dims[0]) * grid.dims[1] * grid.dims[2];
  return cells < 9e15 && (!have || memory_estimate(a, b, grid) < 0.8 * *have);
}

namespace {

void check_memory(const Model& a, const Model& b, const Box& volume, int resolution) {
  if (fits_memory(a, b, volume, resolution)) return;
  const double bytes = memory_estimate(a, b, Grid::over(volume, resolution)), have = available_memory().value_or(1e18);
  int fits = 1, fails = resolution;
  while (fails - fits > 1) {
    const int middle = fits + (fails - fits) / 2;
    (memory_estimate(a, b, Grid::over(volume, middle)) < 0.7 * have ? fits : fails) = middle;
  }
  throw too_little_memory("A resolution of " + std::to_string(resolution), bytes, have,
                          "choose a Resolution of " + std::to_string(fits) + " or less");
}

}  // namespace

Model make_model(const Part& part, const std::string& name) {
  if (part.mesh.faces.empty())
    throw UserError("There are no faces in " + name + "; choose a layer that holds a triangle mesh.");
  if (part.keep.size() != part.mesh.faces.size() || !any(part.keep))
    throw UserError("Nothing of " + name + " is marked to be kept; select faces on it, or give a box or a point.");
  Model m{name, mesh::prepare(part.mesh), {}, {}, {}};
  if (m.prepared.mesh.faces.empty())
    throw UserError("There is no usable face in " + name +
                    " (all have non-finite or coinciding corners); clean the mesh first.");
  for (int f : m.prepared.source_face) m.keep.push_back(part.keep[f]);
  if (!part.drop.empty())
    for (int f : m.prepared.source_face) m.drop.push_back(part.drop[f] && !part.keep[f]);
  if (!any(m.keep))
    throw UserError("What is marked to be kept of " + name +
                    " has no usable face (non-finite or coinciding corners); clean the mesh or mark more.");
  return m;
}

Box transition_volume(const Model& a, const Model& b, const Box& asked) {
  const Box box_a = a.prepared.mesh.bounds(), box_b = b.prepared.mesh.bounds();
  if (asked.isEmpty()) {
    const Box all = box_a.merged(box_b);
    if (!(all.sizes().maxCoeff() > 0)) throw UserError("The models have no extent; choose layers that hold surfaces.");
    return all;
  }
  if (!asked.min().allFinite() || !asked.max().allFinite())
    throw UserError("The volume's corners are not finite numbers; give VolumeMin and VolumeMax in world units.");
  if (!(asked.sizes().minCoeff() > 0))
    throw UserError("The volume has no thickness; make every coordinate of VolumeMax larger than that of VolumeMin.");
  for (const auto& [model, box] : {std::pair(&a, &box_a), std::pair(&b, &box_b)})
    if (!asked.intersects(*box))
      throw UserError("The volume misses " + model->name + "; move the volume to where both models are.");
  // No more than there is to cut, or the voxels would be too large.
  const Box used = asked.intersection(box_a.merged(box_b));
  if (!(used.sizes().maxCoeff() > 0))
    throw UserError(
        "The volume only touches the models; move it so that it holds the place where they are to be joined.");
  return used;
}

bool touches(const Mesh& mesh, int face, const Box& box) {
  if (!box.intersects(mesh.face_box(face))) return false;
  // The box as a unit cell, so that the voxel test serves.
  const Vec3 size = box.sizes().cwiseMax(1e-9 * box.sizes().maxCoeff());
  std::array<Vec3, 3> p;
  for (int k = 0; k < 3; ++k) p[k] = (mesh.corner(face, k) - box.min()).cwiseQuotient(size);
  bool any = false;
  TriangleBoxTest(p[0], p[1], p[2]).for_each_box({1, 1, 1}, [&](int, int, int) { any = true; });
  return any;
}

void check_volume(const Model& model, const Box& volume) {
  bool in_it = false, kept_in_it = false;
  for (int f = 0; f < model.prepared.mesh.face_count() && !kept_in_it; ++f)
    if ((model.keep[f] || !in_it) && touches(model.prepared.mesh, f, volume))
      in_it = true, kept_in_it = kept_in_it || model.keep[f];
  if (!in_it) throw UserError("The volume misses " + model.name + "; move the volume to where both models are.");
  if (!kept_in_it)
    throw UserError("What is to be kept of " + model.name +
                    " lies outside the volume; enlarge the volume or mark a part inside it.");
}

int natural_resolution(const Model& a, const Model& b, const Box& volume) {
  // The edge of an equilateral triangle of the mean area, over what lies in the volume.
  double surface = 0, faces = 0;
  for (const Model* m : {&a, &b})
    for (int f = 0; f < m->prepared.mesh.face_count(); ++f)
      if (volume.intersects(m->prepared.mesh.face_box(f))) surface += area(m->prepared.mesh, f), ++faces;
  const double edge = std::sqrt(std::max(surface / std::max(faces, 1.0), 1e-300) * 4 / std::sqrt(3.0));
  return int(std::clamp(volume.sizes().maxCoeff() / edge, 48.0, 192.0));
}

JointVoxels joint_voxels(Model& a, Model& b, const Box& volume, int resolution, int threads) {
  constexpr int kMost = 1 << 20;  // more would not fit any memory, nor an int
  const Grid grid = Grid::over(volume, std::min(resolution, kMost));
  check_memory(a, b, volume, std::min(resolution, kMost));
  const auto inside = [&](Model& m) {
    std::vector<char> keep(m.keep.size(), 0);
    for (std::size_t f = 0; f < keep.size(); ++f)
      keep[f] = m.keep[f] && volume.intersects(m.prepared.mesh.face_box(int(f)));
    return keep;
  };
  const VoxelSet set_a = rasterize(a.prepared.mesh, {}, grid, threads),
                 set_b = rasterize(b.prepared.mesh, {}, grid, threads);
  const VoxelSet keep_a = rasterize(a.prepared.mesh, inside(a), grid, threads);
  const VoxelSet keep_b = rasterize(b.prepared.mesh, inside(b), grid, threads);
  for (const auto& [model, set, keep] : {std::tuple(&a, &set_a, &keep_a), std::tuple(&b, &set_b, &keep_b)}) {
    if (set->size() == 0)
      throw UserError("The volume misses " + model->name + "; move the volume to where both models are.");
    if (keep->size() == 0)
      throw UserError("What is to be kept of " + model->name +
                      " lies outside the volume; enlarge the volume or mark a part inside it.");
  }
  JointVoxels voxels = join(grid, set_a, set_b, keep_a, keep_b);
  add_outer_pieces(a, true, volume, voxels);
  add_outer_pieces(b, false, volume, voxels);
  return voxels;
}

}  // namespace parts::cut
