// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/seam/clip.h"

#include <algorithm>
#include <unordered_map>

#include "parts/base/disjoint_sets.h"
#include "parts/base/parallel.h"
#include "parts/mesh/attributes.h"

namespace parts::seam {
namespace {

constexpr double kPinned = 0.05;  // the least value at a vertex of a pinned face

/// The mesh while faces are replaced by parts of themselves.
struct Work {
  Mesh mesh;
  std::vector<int> source;
  std::vector<signed char> pinned;
  std::vector<char> dead;
  std::vector<double> value;  ///< per vertex

  int add(int parent, const Triangle& v, const std::array<Vec3, 3>& at) {
    mesh::add_face_within(mesh, parent, v, at);
    source.push_back(source[parent]);
    pinned.push_back(pinned[parent]);
    dead.push_back(0);
    return mesh.face_count() - 1;
  }
};

std::uint64_t edge_key(int a, int b) {
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

using EdgePoints = std::unordered_map<std::uint64_t, int>;

/// Replaces a face by two, three or four at its edges' marked midpoints
/// (mid[k] on edge k, -1 if unmarked). @return the first new face
int split_face(Work& w, int f, std::array<int, 3> mid) {
  const int first = w.mesh.face_count();
  const Triangle t = w.mesh.faces[f];
  const int marked = (mid[0] >= 0) + (mid[1] >= 0) + (mid[2] >= 0);
  int r = 0;  // rotation that brings the pattern into its standard place
  while (marked == 1 ? mid[r] < 0 : marked == 2 && mid[(r + 2) % 3] >= 0) ++r;
  std::array<int, 3> v, m;
  std::array<Vec3, 3> at_v, at_m;
  for (int k = 0; k < 3; ++k) {
    const int c = (k + r) % 3;
    v[k] = t[c], m[k] = mid[c];
    at_v[k] = Vec3::Unit(c), at_m[k] = 0.5 * (Vec3::Unit(c) + Vec3::Unit((c + 1) % 3));
  }
  w.dead[f] = 1;
  if (marked == 1) {
    w.add(f, {v[0], m[0], v[2]}, {at_v[0], at_m[0], at_v[2]});
    w.add(f, {m[0], v[1], v[2]}, {at_m[0], at_v[1], at_v[2]});
  } else if (marked == 2) {
    w.add(f, {m[0], v[1], m[1]}, {at_m[0], at_v[1], at_m[1]});
    const auto& p = w.mesh.vertices;
    if ((p[v[0]] - p[m[1]]).squaredNorm() < (p[m[0]] - p[v[2]]).squaredNorm()) {
      w.add(f, {v[0], m[0], m[1]}, {at_v[0], at_m[0], at_m[1]});
      w.add(f, {v[0], m[1], v[2]}, {at_v[0], at_m[1], at_v[2]});
    } else {
      w.add(f, {v[0], m[0], v[2]}, {at_v[0], at_m[0], at_v[2]});
      w.add(f, {m[0], m[1], v[2]}, {at_m[0], at_m[1], at_v[2]});
    }
  } else {
    w.add(f, {v[0], m[0], m[2]}, {at_v[0], at_m[0], at_m[2]});
    w.add(f, {m[0], v[1], m[1]}, {at_m[0], at_v[1], at_m[1]});
    w.add(f, {m[2], m[1], v[2]}, {at_m[2], at_m[1], at_v[2]});
    w.add(f, {m[0], m[1], m[2]}, {at_m[0], at_m[1], at_m[2]});
  }
  return first;
}

/// Splits the edges of crossed faces down to max_edge, so that the field's sign
/// at the vertices tells where it passes. Pinned faces are left as they are.
void refine(Work& w, const ClipField& field, int threads) {
  std::vector<char> crossed(w.mesh.faces.size(), 0), touched(w.mesh.vertices.size(), 0);
  const auto longest = [&](int f) {
    double l = 0;
    for (int k = 0; k < 3; ++k) l = std::max(l, (w.mesh.corner(f, k) - w.mesh.corner(f, (k + 1) % 3)).norm());
    return l;
  };
  parallel_for(w.mesh.face_count(), threads, [&](long begin, long end) {
    for (int f = int(begin); f < end; ++f)
      crossed[f] = !w.pinned[f] && longest(f) > field.max_edge && field.crosses(w.mesh, f);
  });
  for (int f = 0; f < w.mesh.face_count(); ++f)
    if (crossed[f])
      for (int v : w.mesh.faces[f]) touched[v] = 1;
  std::vector<int> zone;
  EdgePoints whole;  // edges of pinned faces near the zone
  for (int f = 0; f < w.mesh.face_count(); ++f) {
    const Triangle& t = w.mesh.faces[f];
    if (touched[t[0]] + touched[t[1]] + touched[t[2]] < 2) continue;
    if (!w.pinned[f])
      zone.push_back(f);
    else
      for (int k = 0; k < 3; ++k) whole[edge_key(t[k], t[(k + 1) % 3])] = 1;
  }
  // Each round halves what is too long; flat faces beside an edge that must
  // stay whole could go on for ever.
  double most = 0;
  for (int f : zone) most = std::max(most, crossed[f] ? longest(f) : 0);
  const int rounds = most > field.max_edge ? 2 + int(std::log2(std::min(most / field.max_edge, 1e6))) : 0;
  for (int round = 0; round < rounds; ++round) {
    EdgePoints mid;
    for (int f : zone)
      if (crossed[f]) {
        // Beside an edge that must stay whole, splitting the others down to
        // its length would never end.
        double enough = field.max_edge;
        const auto stays = [&](int a, int b) { return whole.count(edge_key(a, b)) > 0; };
        const auto length = [&](int a, int b) { return (w.mesh.vertices[a] - w.mesh.vertices[b]).norm(); };
        const Triangle t = w.mesh.faces[f];
        for (int k = 0; k < 3; ++k)
          if (stays(t[k], t[(k + 1) % 3])) enough = std::max(enough, 1.5 * length(t[k], t[(k + 1) % 3]));
        for (int k = 0; k < 3; ++k) {
          const int a = t[k], b = t[(k + 1) % 3];
          if (length(a, b) <= enough || stays(a, b)) continue;
          if (const auto [it, fresh] = mid.try_emplace(edge_key(a, b), -1); fresh) {
            it->second = mesh::add_vertex_between(w.mesh, std::min(a, b), std::max(a, b), 0.5);
            w.value.push_back(field.value(w.mesh.vertices.back()));
          }
        }
      }
    if (mid.empty()) return;
    std::vector<int> next;
    for (int f : zone) {
      std::array<int, 3> m;
      for (int k = 0; k < 3; ++k) {
        const auto it = mid.find(edge_key(w.mesh.faces[f][k], w.mesh.faces[f][(k + 1) % 3]));
        m[k] = it == mid.end() ? -1 : it->second;
      }
      if (m[0] < 0 && m[1] < 0 && m[2] < 0) {
        next.push_back(f);
        continue;
      }
      const int first = split_face(w, f, m);
      crossed.resize(w.mesh.faces.size(), 0);
      for (int g = first; g < w.mesh.face_count(); ++g) {
        crossed[g] = crossed[f] && longest(g) > field.max_edge && field.crosses(w.mesh, g);
        next.push_back(g);
      }
    }
    zone.swap(next);
  }
}

/// The share of the way from vertex i (kept) to j (not) at which the field
/// vanishes: false position with halving (Illinois).
double root(const Work& w, const ClipField& field, int i, int j) {
  constexpr double kMargin = 0.01;  // no face gets an edge of no length
  double t0 = 0, t1 = 1, f0 = w.value[i], f1 = w.value[j], t = f0 / (f0 - f1);
  int side = 0;
  for (int step = 0; step < 24 && t1 - t0 > 1e-4; ++step) {
    t = f0 == -f1 || step > 10 ? 0.5 * (t0 + t1) : (t0 * f1 - t1 * f0) / (f1 - f0);
    const double f = field.value((1 - t) * w.mesh.vertices[i] + t * w.mesh.vertices[j]);
    if (std::abs(f) < 1e-9) break;
    if (f > 0) {
      t0 = t, f0 = f;
      if (side == 1) f1 /= 2;
      side = 1;
    } else {
      t1 = t, f1 = f;
      if (side == -1) f0 /= 2;
      side = -1;
    }
  }
  return std::clamp(t, kMargin, 1 - kMargin);
}

/// Takes out pieces with cut borders that are no larger than a crumb and of
/// which nothing is pinned: the field's noise where it runs along the surface.
void drop_crumbs(const Work& w, double crumb, int whole_vertices, std::vector<char>& keep,
                 std::vector<std::array<int, 2>>& border) {
  DisjointSets pieces(w.mesh.vertex_count());
  for (std::size_t f = 0; f < keep.size(); ++f)
    if (keep[f])
      for (int k : {1, 2}) pieces.unite(w.mesh.faces[f][0], w.mesh.faces[f][k]);
  std::unordered_map<int, Box> boxes;  // of pieces that the cut made
  for (const auto& e : border)
    if (e[0] >= whole_vertices) boxes[pieces.find(e[0])];
  for (std::size_t f = 0; f < keep.size(); ++f) {
    if (!keep[f]) continue;
    const auto piece = boxes.find(pieces.find(w.mesh.faces[f][0]));
    if (piece == boxes.end()) continue;
    if (w.pinned[f] > 0)
      boxes.erase(piece);
    else
      piece->second.extend(w.mesh.face_box(int(f)));
  }
  const auto is_crumb = [&](int vertex) {
    const auto piece = boxes.find(pieces.find(vertex));
    return piece != boxes.end() && piece->second.sizes().maxCoeff() < crumb;
  };
  for (std::size_t f = 0; f < keep.size(); ++f) keep[f] = keep[f] && !is_crumb(w.mesh.faces[f][0]);
  border.erase(std::remove_if(border.begin(), border.end(), [&](const auto& e) { return is_crumb(e[0]); }),
               border.end());
}

}  // namespace

Clipped clip(const Mesh& mesh, const std::vector<signed char>& pinned, const ClipField& field, int threads) {
  Work w{mesh, {}, pinned, std::vector<char>(mesh.faces.size(), 0), std::vector<double>(mesh.vertices.size())};
  for (int f = 0; f < mesh.face_count(); ++f) w.source.push_back(f);
  parallel_for(mesh.vertex_count(), threads, [&](long begin, long end) {
    for (long v = begin; v < end; ++v) w.value[v] = field.value(mesh.vertices[v]);
  });
  for (int f = 0; f < mesh.face_count(); ++f)
    if (pinned[f] < 0)
      for (int v : mesh.faces[f]) w.value[v] = std::min(w.value[v], -kPinned);
  for (int f = 0; f < mesh.face_count(); ++f)
    if (pinned[f] > 0)
      for (int v : mesh.faces[f]) w.value[v] = std::max(w.value[v], kPinned);
  refine(w, field, threads);

  EdgePoints cut;
  const int whole_vertices = w.mesh.vertex_count();
  std::vector<std::array<int, 2>> border;
  std::vector<char> keep;
  const int faces = w.mesh.face_count();
  const auto point = [&](int inside, int outside) {
    const auto [it, fresh] = cut.try_emplace(edge_key(inside, outside), -1);
    if (fresh) it->second = mesh::add_vertex_between(w.mesh, inside, outside, root(w, field, inside, outside));
    return it->second;
  };
  const auto share = [&](int f, int k, int p) {  // barycentric place of point p on the edge that starts at corner k
    const Vec3 &a = w.mesh.corner(f, k), &b = w.mesh.corner(f, (k + 1) % 3);
    const double length = (b - a).norm(), t = length > 0 ? (w.mesh.vertices[p] - a).norm() / length : 0;
    return Vec3((1 - t) * Vec3::Unit(k) + t * Vec3::Unit((k + 1) % 3));
  };
  for (int f = 0; f < faces; ++f) {
    if (w.dead[f]) continue;
    const Triangle t = w.mesh.faces[f];
    bool in[3];
    for (int k = 0; k < 3; ++k) in[k] = w.value[t[k]] > 0;
    const int inside = in[0] + in[1] + in[2];
    if (inside == 3) continue;
    w.dead[f] = 1;
    if (inside == 0) continue;
    // Corner a is the one that stands alone; its edges to b and c are cut.
    const int k = inside == 1 ? (in[0] ? 0 : in[1] ? 1 : 2) : (!in[0] ? 0 : !in[1] ? 1 : 2);
    const int kb = (k + 1) % 3, kc = (k + 2) % 3, a = t[k], b = t[kb], c = t[kc];
    const int ab = inside == 1 ? point(a, b) : point(b, a), ac = inside == 1 ? point(a, c) : point(c, a);
    const Vec3 at_ab = share(f, k, ab), at_ac = share(f, kc, ac);
    if (inside == 1) {
      w.add(f, {a, ab, ac}, {Vec3::Unit(k), at_ab, at_ac});
      border.push_back({ab, ac});
    } else {
      const auto& p = w.mesh.vertices;
      if ((p[ab] - p[c]).squaredNorm() < (p[ac] - p[b]).squaredNorm()) {
        w.add(f, {ab, b, c}, {at_ab, Vec3::Unit(kb), Vec3::Unit(kc)});
        w.add(f, {ab, c, ac}, {at_ab, Vec3::Unit(kc), at_ac});
      } else {
        w.add(f, {ab, b, ac}, {at_ab, Vec3::Unit(kb), at_ac});
        w.add(f, {b, c, ac}, {Vec3::Unit(kb), Vec3::Unit(kc), at_ac});
      }
      border.push_back({ac, ab});
    }
  }
  for (char d : w.dead) keep.push_back(!d);
  drop_crumbs(w, field.crumb, whole_vertices, keep, border);

  Clipped out;
  std::vector<int> old_vertex, old_face, number(w.mesh.vertices.size(), -1);
  out.mesh = mesh::take_faces(w.mesh, keep, &old_vertex, &old_face);
  for (int f : old_face) out.source_face.push_back(w.source[f]);
  for (std::size_t v = 0; v < old_vertex.size(); ++v) {
    number[old_vertex[v]] = int(v);
    out.cut_vertex.push_back(old_vertex[v] >= whole_vertices);
  }
  for (const auto& e : border) out.border.push_back({number[e[0]], number[e[1]]});
  return out;
}

}  // namespace parts::seam
