// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/mesh_cut.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <unordered_map>

#include "parts/base/error.h"

namespace parts::cut {
namespace {

// In lengths of S.
constexpr double kCoarseEdge = 0.08, kFineEdge = 0.03;  // the longest edges of the work meshes
constexpr double kCoarseReach = 0.02;                   // the first reach
constexpr double kZone = 0.1;                           // how near the other model, or the coarse seam, they are split

std::uint64_t edge_key(int a, int b) {
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

/// Everything that the coarse and the fine cut have in common.
class MeshCutter {
 public:
  MeshCutter(const Model& a, const Model& b, const Box& volume, int threads)
      : model_{&a, &b},
        volume_(volume),
        threads_(threads),
        tree_{spatial::FaceTree(mesh(0)), spatial::FaceTree(mesh(1))},
        curve_(find_crossings(mesh(0), tree_[0], mesh(1), tree_[1])) {
    problem_.scale = std::min(rms_size(mesh(0)), rms_size(mesh(1)));
    if (!(scale() > 0)) throw UserError("A model has no area; choose layers that hold surfaces.");
    for (int x : {0, 1}) {
      const std::vector<char>& keep = model_[x]->keep;
      marks_[x].assign(mesh(x).faces.size(), 0);
      still_[x].assign(mesh(x).vertices.size(), 0);
      for (int f = 0; f < mesh(x).face_count(); ++f) {
        if (keep[f])
          marks_[x][f] = x ? kOfB : kOfA;
        else if (!model_[x]->drop.empty() && model_[x]->drop[f])
          marks_[x][f] = x ? kOfA : kOfB;
        if (keep[f] || !volume_.contains(mesh(x).face_box(f)))
          for (int v : mesh(x).faces[f]) still_[x][v] = 1;
      }
    }
  }

  /// @throws UserError  the marks contradict each other
  void check_marks() const {
    constexpr double kSame = 0.003;  // of S: nearer, kept faces that look the same way are one place
    for (int x : {0, 1}) {
      const std::vector<char>&keep = model_[x]->keep, &other = model_[1 - x]->keep;
      double kept = 0, shared = 0;
      for (int f = 0; f < mesh(x).face_count(); ++f) {
        if (!keep[f]) continue;
        const spatial::FaceTree::Hit hit = tree_[1 - x].nearest(mesh(x).center(f), kSame * scale());
        kept += mesh(x).area(f);
        if (hit.face >= 0 && other[hit.face] && mesh(x).normal(f).dot(mesh(1 - x).normal(hit.face)) > 0.9)
          shared += mesh(x).area(f);
      }
      if (shared > 0.5 * kept)
        throw UserError("What is to be kept of the two models lies in the same place; mark parts farther apart.");
    }
  }

  /// @throws UserError  there is no cut
  void cut_coarsely() {
    std::vector<char> open[2];
    for (int x : {0, 1})
      for (Territory mark : marks_[x]) open[x].push_back(!mark);
    prepare(marks_, open, kCoarseEdge, [&](int x, const Vec3& p, double distance) {
      return tree_[1 - x].nearest(p, kZone * scale() + distance).face >= 0;
    });
    labels_ = choose_labels(problem_, kCoarseReach * scale(), 1, threads_);
    if (labels_.found) return;
    if (!labels_.possible)
      throw UserError(
          "What is to be kept and what must go cannot be parted: the models do not come near each other between them; "
          "mark less, or move the models farther into each other.");
    throw UserError(
        "The models do not touch between what is to be kept of A and of B; move them closer until they overlap.");
  }

  /// Again around the seam found, with shorter edges. Leaves things as they are where that finds none.
  void cut_finely() {
    std::vector<Territory> forced[2];
    std::vector<char> open[2];
    const Zone zone = seam_zone();
    lock_far_faces(zone, forced, open);
    MeshProblem coarse = std::move(problem_);
    MeshLabels labels = std::move(labels_);
    std::vector<SplitPoint> points[2] = {std::move(points_[0]), std::move(points_[1])};
    problem_ = MeshProblem();
    problem_.scale = coarse.scale;
    prepare(forced, open, kFineEdge, [&](int, const Vec3& p, double distance) {
      return zone.tree.nearest(p, zone.radius + distance).face >= 0;
    });
    labels_ = choose_labels(problem_, std::max(kCoarseReach * scale(), labels.reach / 2), 0, threads_);
    if (labels_.found) return;
    problem_ = std::move(coarse), labels_ = std::move(labels);
    for (int x : {0, 1}) points_[x] = std::move(points[x]);
  }

  /// Components that hold no mark and that no seam parts (eyes in a head, a
  /// button on a coat) go with what is nearest to them on their model.
  void settle_isolated() {
    for (int x : {0, 1}) {
      const WorkMesh& w = problem_.side[x];
      const mesh::Prepared& prepared = model_[x]->prepared;
      const auto component = [&](int f) { return prepared.component[w.source[f]]; };
      std::vector<Territory> label(prepared.components, 0);
      std::vector<char> decided(prepared.components, 0);
      for (int f = 0; f < w.mesh.face_count(); ++f) {
        Territory& of_component = label[component(f)];
        const Territory own = labels_.label[x][f];
        if (marks_[x][w.source[f]] || (of_component && of_component != own)) decided[component(f)] = 1;
        of_component = own;
      }
      Mesh known;
      std::vector<int> number;
      known.vertices = w.mesh.vertices;
      for (int f = 0; f < w.mesh.face_count(); ++f)
        if (decided[component(f)]) known.faces.push_back(w.mesh.faces[f]), number.push_back(f);
      if (known.faces.empty() || known.faces.size() == w.mesh.faces.size()) continue;
      const spatial::FaceTree tree(known);
      std::vector<spatial::FaceTree::Hit> nearest(prepared.components);
      for (int f = 0; f < w.mesh.face_count(); ++f)
        if (spatial::FaceTree::Hit& best = nearest[component(f)]; !decided[component(f)])
          if (const auto hit = tree.nearest(w.mesh.center(f), best.distance); hit.face >= 0) best = hit;
      std::vector<Territory>& labels = labels_.label[x];
      for (int f = 0; f < w.mesh.face_count(); ++f)
        if (const auto& hit = nearest[component(f)]; !decided[component(f)] && hit.face >= 0)
          labels[f] = labels[number[hit.face]];
    }
  }

  MeshCut borders() {
    const SeamValues values = smooth_values(*model_[0], *model_[1], problem_, labels_, curve_, kFineEdge * scale());
    MeshCut cut;
    cut.edge = values.edge, cut.gap = values.gap;
    for (int x : {0, 1}) cut.border[x] = smooth_border(labelled(x), values), cut.loops[x] = count_loops(labelled(x));
    return cut;
  }

  LabelledModel labelled(int x) const {
    return {mesh(x), x, points_[x], still_[x], curve_, problem_.side[x], labels_.label[x]};
  }

  void report(CutReport& r) const {
    r.scale = scale(), r.reach = labels_.reach;
    r.crossing_segments = long(curve_.segments.size()), r.broken_ties = labels_.broken;
    r.cut_cost = labels_.objective;
  }

 private:
  const Mesh& mesh(int x) const { return model_[x]->prepared.mesh; }
  double scale() const { return problem_.scale; }

  double longest_edge(int x, int f) const {
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (mesh(x).corner(f, k) - mesh(x).corner(f, (k + 1) % 3)).norm());
    return longest;
  }

  /// Makes the work meshes: the models split along the curve, the flagged faces down to an edge.
  /// @param near  of A's (0) or B's surface: whether points are wanted within a distance of a place
  void prepare(const std::vector<Territory> (&forced)[2], const std::vector<char> (&split)[2], double edge,
               const std::function<bool(int, const Vec3&, double)>& near) {
    for (int x : {0, 1}) {
      points_[x] = split_points(curve_, mesh(x), x == 0);
      add_even_points(
          mesh(x), split[x], still_[x], edge * scale(),
          [&](const Vec3& p, double distance) { return near(x, p, distance); }, points_[x]);
      std::vector<SplitSegment> segments;
      for (const CrossingSegment& s : curve_.segments) segments.push_back({x ? s.face_b : s.face_a, s.ends});
      problem_.side[x] = make_work_mesh(*model_[x], volume_, forced[x], points_[x], segments);
    }
    find_ties();
  }

  /// The crossing segments that are edges of both work meshes.
  void find_ties() {
    std::unordered_map<std::uint64_t, int> edge_at[2];
    for (int x : {0, 1})
      for (std::size_t e = 0; e < problem_.side[x].edges.size(); ++e)
        if (const WorkMesh::Edge& edge = problem_.side[x].edges[e]; edge.low >= mesh(x).vertex_count())
          edge_at[x][edge_key(edge.low, edge.high)] = int(e);
    for (int s = 0; s < int(curve_.segments.size()); ++s) {
      WorkMesh::Edge* edge[2];
      bool good = true;
      for (int x : {0, 1}) {
        WorkMesh& w = problem_.side[x];
        const int p = w.vertex_of[curve_.segments[s].ends[0]], q = w.vertex_of[curve_.segments[s].ends[1]];
        const auto it = edge_at[x].find(edge_key(p, q));
        good = good && p != q && it != edge_at[x].end();
        edge[x] = good ? &w.edges[it->second] : nullptr;
        good = good && edge[x]->end_face - edge[x]->first_face == 2;
      }
      if (good) problem_.ties.push_back(tie(s, *edge[0], *edge[1]));
    }
  }

  Tie tie(int s, WorkMesh::Edge& edge_a, WorkMesh::Edge& edge_b) const {
    const CrossingSegment& segment = curve_.segments[s];
    const Vec3 normal_a = mesh(0).normal(segment.face_a), normal_b = mesh(1).normal(segment.face_b);
    const Vec3 &from = curve_.points[segment.ends[0]].position, &to = curve_.points[segment.ends[1]].position;
    // Of an edge's two faces, the one in front of the other model's face first.
    const auto sides = [&](const WorkMesh& w, const WorkMesh::Edge& e, const Vec3& normal) {
      std::array<int, 2> face{w.edge_faces[e.first_face], w.edge_faces[e.first_face + 1]};
      const auto height = [&](int f) {
        for (int v : w.mesh.faces[f])
          if (v != e.low && v != e.high) return normal.dot(w.mesh.vertices[v] - from);
        return 0.0;
      };
      if (height(face[0]) <= height(face[1])) std::swap(face[0], face[1]);
      return face;
    };
    const auto [a_outside, a_inside] = sides(problem_.side[0], edge_a, normal_b);
    const auto [b_outside, b_inside] = sides(problem_.side[1], edge_b, normal_a);
    Tie t{s, a_outside, a_inside, b_outside, b_inside, (to - from).norm(), 1 - normal_a.dot(normal_b), false};
    edge_a.turn = edge_b.turn = std::max(0.0, t.turn);
    const Vec3 middle = 0.5 * (from + to);
    t.hidden = inside_itself(0, segment.face_a, middle, normal_a) || inside_itself(1, segment.face_b, middle, normal_b);
    return t;
  }

  /// Whether a point on a closed model lies inside another part of it.
  bool inside_itself(int x, int face, const Vec3& p, const Vec3& normal) const {
    const mesh::Prepared& m = model_[x]->prepared;
    const Vec3 aslant(1.3e-3, -2.1e-3, 0.7e-3);  // past edges that the normal would meet
    return m.closed[m.component[face]] && tree_[x].winding(p, (normal + aslant).normalized(), 1e-5 * scale()) != 0;
  }

  /// The surroundings of the seam found.
  struct Zone {
    spatial::FaceTree tree;  ///< of its edges
    double radius;           ///< world units
  };
  Zone seam_zone() const {
    Mesh seam;  // its edges, as faces without area
    double edges = 0;
    long count = 0;
    for (int x : {0, 1}) {
      const WorkMesh& w = problem_.side[x];
      for (const WorkMesh::Edge& e : w.edges) {
        if (!w.cut(e, labels_.label[x])) continue;
        const int v = seam.vertex_count();
        seam.vertices.push_back(w.mesh.vertices[e.low]), seam.vertices.push_back(w.mesh.vertices[e.high]);
        seam.faces.push_back({v, v + 1, v + 1});
        for (int k = e.first_face; k < e.end_face; ++k, ++count)
          edges += std::min(longest_edge(x, w.source[w.edge_faces[k]]), kCoarseEdge * scale());
      }
    }
    return {spatial::FaceTree(seam),
            std::max({kZone * scale(), 1.5 * labels_.reach, 2 * edges / double(std::max(1L, count))})};
  }

  /// Faces far from the seam keep their label; the others are open again.
  void lock_far_faces(const Zone& zone, std::vector<Territory> (&forced)[2], std::vector<char> (&open)[2]) const {
    for (int x : {0, 1}) {
      const WorkMesh& w = problem_.side[x];
      forced[x] = marks_[x];
      open[x].assign(mesh(x).faces.size(), 0);
      std::vector<Territory> label(mesh(x).faces.size(), 0);
      for (int f = 0; f < w.mesh.face_count(); ++f) label[w.source[f]] = labels_.label[x][f];
      for (int f = 0; f < mesh(x).face_count(); ++f) {
        if (forced[x][f]) continue;
        const Vec3 center = mesh(x).center(f);
        double radius = 0;
        for (int k = 0; k < 3; ++k) radius = std::max(radius, (mesh(x).corner(f, k) - center).norm());
        open[x][f] = zone.tree.nearest(center, zone.radius + radius).face >= 0;
        if (!open[x][f]) forced[x][f] = label[f];
      }
    }
  }

  const Model* model_[2];
  const Box volume_;
  const int threads_;
  spatial::FaceTree tree_[2];
  CrossingCurve curve_;
  std::vector<Territory> marks_[2];  ///< per face
  std::vector<char> still_[2];       ///< per vertex: of a face that stays whole
  std::vector<SplitPoint> points_[2];
  MeshProblem problem_;
  MeshLabels labels_;
};

}  // namespace

MeshCut cut_meshes(const Model& a, const Model& b, const Box& volume, int threads, CutReport& report,
                   Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const auto cutter = std::make_shared<MeshCutter>(a, b, volume, threads);
  progress.at(0.2);
  cutter->check_marks();
  cutter->cut_coarsely();
  progress.at(0.6);
  cutter->cut_finely();
  cutter->settle_isolated();
  progress.at(0.8);
  cutter->report(report);
  MeshCut cut = cutter->borders();
  cut.raw_border = [cutter](int side) { return raw_border(cutter->labelled(side)); };
  report.cut_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return cut;
}

}  // namespace parts::cut
