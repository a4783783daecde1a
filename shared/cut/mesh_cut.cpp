// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/cut/mesh_cut.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <unordered_map>
#include <unordered_set>

#include "parts/base/error.h"

namespace parts::cut {
namespace {

// In lengths of S.
constexpr double kCoarseEdge = 0.08, kFineEdge = 0.03;  // the longest edges of the work meshes
constexpr double kCoarseReach = 0.02;                   // the first reach
constexpr double kStep = 1e-6;                          // what is nearer than this is one place
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
    find_twins();
    find_ties();
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
    const std::vector<int> point = points_at(0);
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

  /// Per vertex of a work mesh the first point of both models there, or -1.
  std::vector<int> points_at(int x) const {
    const WorkMesh& w = problem_.side[x];
    std::vector<int> point(w.mesh.vertices.size(), -1);
    for (int p = int(curve_.points.size()); p-- > 0;)
      if (w.vertex_of[p] >= 0) point[w.vertex_of[p]] = p;
    return point;
  }

  /// Faces of both between the same points: one surface, if they look the same way.
  void find_twins() {
    std::map<Triangle, int> face_at;
    const auto key = [&](int x, int f, const std::vector<int>& point) {
      Triangle t = problem_.side[x].mesh.faces[f];
      for (int& v : t) v = point[v];
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      return t;
    };
    const std::vector<int> of_a = points_at(0), of_b = points_at(1);
    WorkMesh &a = problem_.side[0], &b = problem_.side[1];
    for (int f = 0; f < a.mesh.face_count(); ++f)
      if (const Triangle t = key(0, f, of_a); t[0] >= 0) face_at[t] = f;
    for (int g = 0; g < b.mesh.face_count() && !face_at.empty(); ++g)
      if (const Triangle t = key(1, g, of_b); t[0] >= 0)
        if (const auto f = face_at.find(t); f != face_at.end()) b.twin[g] = f->second, a.twin[f->second] = g;
  }

  /// The crossing segments that are edges of both work meshes.
  void find_ties() {
    std::vector<char> at_curve[2];
    for (int x : {0, 1}) {
      at_curve[x].assign(problem_.side[x].mesh.vertices.size(), 0);
      for (const CrossingSegment& s : curve_.segments)
        for (int end : s.ends)
          if (const int v = problem_.side[x].vertex_of[end]; v >= 0) at_curve[x][v] = 1;
    }
    std::unordered_map<std::uint64_t, int> edge_at[2];
    for (int x : {0, 1})
      for (std::size_t e = 0; e < problem_.side[x].edges.size(); ++e)
        if (const WorkMesh::Edge& edge = problem_.side[x].edges[e]; at_curve[x][edge.low] && at_curve[x][edge.high])
          edge_at[x][edge_key(edge.low, edge.high)] = int(e);
    std::unordered_set<std::uint64_t> tied;
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
      if (good && tied.insert(edge_key(edge[0]->low, edge[0]->high)).second) tie(s, *edge[0], *edge[1]);
    }
  }

  /// An edge's two faces: the one whose side runs as the edge does, and the other.
  static std::array<int, 2> forth_and_back(const WorkMesh& w, const WorkMesh::Edge& e, int from) {
    std::array<int, 2> face{w.edge_faces[e.first_face], w.edge_faces[e.first_face + 1]};
    const auto forth = [&](int f) {
      const Triangle& t = w.mesh.faces[f];
      for (int k = 0; k < 3; ++k)
        if (t[k] == from) return t[(k + 1) % 3] == e.low || t[(k + 1) % 3] == e.high;
      return false;
    };
    if (!forth(face[0])) std::swap(face[0], face[1]);
    return face;
  }

  /// Ties the faces at an edge that both models have, if they part there, or cross.
  void tie(int s, WorkMesh::Edge& edge_a, WorkMesh::Edge& edge_b) {
    constexpr double kFlat = 1e-4;   // radians: faces at a smaller angle lie on each other
    constexpr double kClear = 0.06;  // the least 1 - cosine of an angle that is no accident
    const CrossingSegment& segment = curve_.segments[s];
    const Vec3 from = curve_.points[segment.ends[0]].position(),
               along = curve_.points[segment.ends[1]].position() - from;
    const WorkMesh &a = problem_.side[0], &b = problem_.side[1];
    const auto [a_forth, a_back] = forth_and_back(a, edge_a, a.vertex_of[segment.ends[0]]);
    const auto [b_forth, b_back] = forth_and_back(b, edge_b, b.vertex_of[segment.ends[0]]);
    // Angles around the edge, from A's first face on. Seen against it, the outside lies to the left of a
    // face that runs forth, the inside to that of one that runs back.
    const auto inwards = [&](const WorkMesh& w, const WorkMesh::Edge& e, int f) {
      Vec3 third = from;
      for (int v : w.mesh.faces[f])
        if (v != e.low && v != e.high) third = w.mesh.vertices[v];
      return Vec3(third - from - along * ((third - from).dot(along) / along.squaredNorm()));
    };
    const Vec3 right = inwards(a, edge_a, a_forth), up = along.normalized().cross(right);
    const auto angle = [&](const WorkMesh& w, const WorkMesh::Edge& e, int f) {
      const Vec3 d = inwards(w, e, f);
      const double t = std::atan2(d.dot(up), d.dot(right));
      return t < 0 ? t + 2 * M_PI : t;
    };
    const double turn_a = angle(a, edge_a, a_back), forth = angle(b, edge_b, b_forth), back = angle(b, edge_b, b_back);
    const auto flat = [](double t) { return std::min(std::abs(t), 2 * M_PI - std::abs(t)) < kFlat; };
    const bool same_forth = flat(forth), same_back = flat(back - turn_a);
    const auto add = [&](int a_outside, int a_inside, int b_outside, int b_inside, double turn, bool clear) {
      Tie t{s, a_outside, a_inside, b_outside, b_inside, along.norm(), turn, clear, false};
      edge_a.turn = edge_b.turn = std::max(0.0, turn);
      const Vec3 middle = from + 0.5 * along;
      t.hidden = inside_itself(0, segment.face_a, middle, mesh(0).normal(segment.face_a)) ||
                 inside_itself(1, segment.face_b, middle, mesh(1).normal(segment.face_b));
      problem_.ties.push_back(t);
    };
    const auto turn_between = [&](int f, int g) { return 1 - a.normal[f].dot(b.normal[g]); };
    if (same_forth && same_back) return;
    if (same_forth || same_back) {
      const int a_one = same_forth ? a_forth : a_back, a_other = same_forth ? a_back : a_forth;
      const int b_one = same_forth ? b_forth : b_back, b_other = same_forth ? b_back : b_forth;
      const double parting = turn_a - (same_forth ? back : forth);
      add(a_other, a_one, b_one, b_other, std::min(turn_between(a_other, b_one), turn_between(a_one, b_other)),
          1 - std::cos(same_forth ? parting : forth) >= kClear);
      return;
    }
    const bool contact_forth = flat(back), contact_back = flat(forth - turn_a);
    if (contact_forth || contact_back) {
      // Beyond the contact the other must lie outside, or all is inside.
      if (contact_forth && contact_back) return;
      if (contact_forth ? forth < turn_a : back < turn_a)
        add(contact_forth ? a_back : a_forth, contact_forth ? a_forth : a_back, contact_forth ? b_forth : b_back,
            contact_forth ? b_back : b_forth,
            contact_forth ? turn_between(a_back, b_forth) : turn_between(a_forth, b_back), true);
      return;
    }
    const bool forth_outside = forth < turn_a, back_outside = back < turn_a;
    if (forth_outside == back_outside) return;  // they touch
    const double to_back = back > forth ? back - forth : back - forth + 2 * M_PI, to_a = 2 * M_PI - forth;
    const bool a_forth_outside = to_a < to_back;
    const int a_outside = a_forth_outside ? a_forth : a_back, b_outside = forth_outside ? b_forth : b_back;
    const double turn = turn_between(a_outside, b_outside);
    add(a_outside, a_forth_outside ? a_back : a_forth, b_outside, forth_outside ? b_back : b_forth, turn,
        turn >= kClear);
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
