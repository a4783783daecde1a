// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/mesh_cut.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <unordered_map>

#include "parts/base/error.h"
#include "parts/cut/ties.h"

namespace parts::cut {
namespace {

// In lengths of S.
constexpr double kCoarseEdge = 0.08, kFineEdge = 0.03;  // the longest edges of the work meshes
constexpr double kCoarseReach = 0.02;                   // the first reach
constexpr double kStep = 1e-6;                          // what is nearer than this is one place
constexpr double kZone = 0.1;                           // how near the other model, or the coarse seam, they are split

/// Everything that the coarse and the fine cut have in common.
class MeshCutter {
 public:
  MeshCutter(const Model& a, const Model& b, const Box& volume, int threads)
      : model_{&a, &b},
        volume_(volume),
        threads_(threads),
        tree_{spatial::FaceTree(mesh(0)), spatial::FaceTree(mesh(1))} {
    problem_.scale = std::min(rms_size(mesh(0)), rms_size(mesh(1)));
    if (!(scale() > 0)) throw UserError("A model has no area; choose layers that hold surfaces.");
    found_ = find_crossings(mesh(0), tree_[0], mesh(1), tree_[1], coordinate_step(), threads);
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
    CrossingCurve curve = curve_;
    std::vector<SplitPoint> points[2] = {std::move(points_[0]), std::move(points_[1])};
    problem_ = MeshProblem();
    problem_.scale = coarse.scale;
    prepare(forced, open, kFineEdge, [&](int, const Vec3& p, double distance) {
      return zone.tree.nearest(p, zone.radius + distance).face >= 0;
    });
    labels_ = choose_labels(problem_, std::max(kCoarseReach * scale(), labels.reach / 2), 0, threads_);
    if (labels_.found) return;
    problem_ = std::move(coarse), labels_ = std::move(labels), curve_ = std::move(curve);
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

  MeshCut borders(bool even) {
    const SeamValues values = smooth_values(*model_[0], *model_[1], problem_, labels_, curve_, kFineEdge * scale());
    MeshCut cut;
    cut.edge = values.edge, cut.gap = values.gap, cut.step = 4 * curve_.step;
    for (int x : {0, 1}) {
      cut.border[x] = smooth_border(labelled(x), values, even), cut.loops[x] = count_loops(labelled(x));
      find_same(x, cut.border[x]);
    }
    return cut;
  }

  /// Of the faces at a border those that lie on the other model too.
  void find_same(int x, MeshBorder& border) const {
    constexpr double kNear = 0.005;  // of S
    const Mesh& split = border.split.mesh;
    border.same.assign(split.faces.size(), 0);
    for (int f = 0; f < split.face_count(); ++f) {
      const Triangle& t = split.faces[f];
      if (border.value[t[0]] != 0 && border.value[t[1]] != 0 && border.value[t[2]] != 0) continue;
      // A large face may lie on it only where the border is.
      Vec3 at = Vec3::Zero();
      int count = 0;
      for (int v : t)
        if (border.value[v] == 0) at += split.vertices[v], ++count;
      at /= count;
      const Vec3 inwards = split.center(f) - at;
      at += std::min(1.0, kNear * scale() / std::max(inwards.norm(), 1e-300)) * inwards;
      const spatial::FaceTree::Hit hit = tree_[1 - x].nearest(at, 2 * curve_.step);
      border.same[f] = hit.face >= 0 && split.normal(f).dot(mesh(1 - x).normal(hit.face)) > 0.9;
    }
  }

  LabelledModel labelled(int x) const {
    return {mesh(x), x, points_[x], still_[x], curve_, problem_.side[x], labels_.label[x]};
  }

  void report(CutReport& r) const {
    r.scale = scale(), r.reach = labels_.reach;
    r.crossing_segments = long(found_.segments.size()), r.broken_ties = labels_.broken;
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

  /// What files store coordinates to, a few times over.
  double coordinate_step() const {
    double largest = 0;
    for (int x : {0, 1}) {
      const Box box = mesh(x).bounds();
      largest = std::max({largest, box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff()});
    }
    return std::max(kStep * scale(), 0x1p-21 * largest);
  }

  /// Makes the work meshes: the models split along the curve, the flagged faces down to an edge.
  /// @param near  of A's (0) or B's surface: whether points are wanted within a distance of a place
  void prepare(const std::vector<Territory> (&forced)[2], const std::vector<char> (&split)[2], double edge,
               const std::function<bool(int, const Vec3&, double)>& near) {
    curve_ = found_;
    std::vector<SplitPoint> even[2];
    for (int x : {0, 1})
      add_even_points(
          mesh(x), split[x], still_[x], edge * scale(),
          [&](const Vec3& p, double distance) { return near(x, p, distance); }, even[x]);
    share_even_points(even);
    part_segments();
    const auto make = [&](int x) {
      points_[x] = split_points(curve_, x);
      points_[x].insert(points_[x].end(), even[x].begin(), even[x].end());
      std::vector<SplitSegment> segments;
      for (const CrossingSegment& s : curve_.segments) segments.push_back({x ? s.face_b : s.face_a, s.ends});
      problem_.side[x] = make_work_mesh(*model_[x], volume_, forced[x], points_[x], segments);
    };
    make(0);
    imprint();
    make(1);
    find_twins(problem_, curve_);
    find_ties(problem_, curve_, {model_[0], model_[1]}, tree_);
  }

  /// Where the models lie on each other A's even points are B's too, and B has none of its own.
  void share_even_points(std::vector<SplitPoint> (&even)[2]) {
    std::vector<SplitPoint> own;
    for (const SplitPoint& p : even[0]) {
      const SplitPoint image = place_on(mesh(1), tree_[1], p.position, curve_.step);
      if (!image.anywhere())
        own.push_back(p);
      else if (image.vertex < 0)  // or it is a point of both already
        curve_.points.push_back({{p, image}});
    }
    even[0].swap(own);
    const auto on_a = [&](const SplitPoint& p) {
      return place_on(mesh(0), tree_[0], p.position, curve_.step).anywhere();
    };
    even[1].erase(std::remove_if(even[1].begin(), even[1].end(), on_a), even[1].end());
  }

  /// Parts segments along the models' edges at the even points on these.
  void part_segments() {
    std::unordered_map<std::uint64_t, std::vector<std::pair<double, int>>> on_edge[2];
    for (std::size_t p = found_.points.size(); p < curve_.points.size(); ++p)
      for (int x : {0, 1})
        if (const SplitPoint& on = curve_.points[p].on[x]; on.edge[0] >= 0)
          on_edge[x][edge_key(on.edge[0], on.edge[1])].emplace_back(on.share, int(p));
    for (int x : {0, 1}) {
      for (auto& [edge, points] : on_edge[x]) std::sort(points.begin(), points.end());
      std::vector<CrossingSegment> parts;
      for (const CrossingSegment& s : curve_.segments) {
        const auto [low, high] = common_edge(x, s.ends);
        const auto points = low >= 0 ? on_edge[x].find(edge_key(low, high)) : on_edge[x].end();
        std::array<int, 2> ends = s.ends;
        if (points != on_edge[x].end()) {
          const auto share = [&, high = high](int p) {
            const SplitPoint& on = curve_.points[p].on[x];
            return on.vertex >= 0 ? double(on.vertex == high) : on.share;
          };
          if (share(ends[0]) > share(ends[1])) std::swap(ends[0], ends[1]);
          for (const auto& [at, p] : points->second)
            if (at > share(ends[0]) && at < share(ends[1])) {
              parts.push_back({s.face_a, s.face_b, {ends[0], p}});
              ends[0] = p;
            }
        }
        parts.push_back({s.face_a, s.face_b, ends});
      }
      curve_.segments.swap(parts);
    }
  }

  /// The edge of a model that two points lie on, {-1, -1} if on none.
  std::array<int, 2> common_edge(int x, const std::array<int, 2>& ends) const {
    const SplitPoint &p = curve_.points[ends[0]].on[x], &q = curve_.points[ends[1]].on[x];
    std::array<int, 2> edge = p.edge[0] >= 0 ? p.edge : q.edge;
    if (p.vertex >= 0 && q.vertex >= 0) edge = {std::min(p.vertex, q.vertex), std::max(p.vertex, q.vertex)};
    return edge[0] >= 0 && p.on(edge[0], edge[1]) && q.on(edge[0], edge[1]) ? edge : std::array<int, 2>{-1, -1};
  }

  /// Where the models lie on each other B gets the edges of A's work mesh.
  void imprint() {
    const WorkMesh& w = problem_.side[0];
    const std::vector<int> point = points_at(w, curve_);
    for (const WorkMesh::Edge& e : w.edges) {
      const int p = point[e.low], q = point[e.high];
      if (p < 0 || q < 0) continue;
      const spatial::FaceTree::Hit hit =
          tree_[1].nearest(0.5 * (w.mesh.vertices[e.low] + w.mesh.vertices[e.high]), curve_.step);
      if (hit.face < 0 || !curve_.points[p].on[1].within(mesh(1), hit.face) ||
          !curve_.points[q].on[1].within(mesh(1), hit.face))
        continue;
      for (int k = e.first_face; k < e.end_face; ++k)
        curve_.segments.push_back({w.source[w.edge_faces[k]], hit.face, {p, q}});
    }
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
  CrossingCurve found_, curve_;      ///< as found, and with what is shared and imprinted
  std::vector<Territory> marks_[2];  ///< per face
  std::vector<char> still_[2];       ///< per vertex: of a face that stays whole
  std::vector<SplitPoint> points_[2];
  MeshProblem problem_;
  MeshLabels labels_;
};

}  // namespace

MeshCut cut_meshes(const Model& a, const Model& b, const Box& volume, bool even, int threads, CutReport& report,
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
  MeshCut cut = cutter->borders(even);
  cut.raw_border = [cutter](int side) { return raw_border(cutter->labelled(side)); };
  report.cut_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return cut;
}

}  // namespace parts::cut
