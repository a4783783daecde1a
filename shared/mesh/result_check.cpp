// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/mesh/result_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <set>
#include <stdexcept>

#include "parts/base/disjoint_sets.h"
#include "parts/mesh/attributes.h"
#include "parts/mesh/edges.h"
#include "parts/mesh/prepare.h"
#include "parts/mesh/self_intersections.h"
#include "parts/mesh/topology.h"

namespace parts::mesh {
namespace {

using Key = std::uint64_t;

Key mixed(Key x) {  // the finalizer of SplitMix64 (Steele, Lea, Flood 2014)
  x += 0x9e3779b97f4a7c15;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
  x = (x ^ x >> 27) * 0x94d049bb133111eb;
  return x ^ x >> 31;
}

Key key_of(const Vec3& place) {
  Key key = 0;
  for (int k = 0; k < 3; ++k) {
    const double x = place[k] + 0.0;  // one zero
    Key bits;
    std::memcpy(&bits, &x, sizeof bits);
    key = mixed(key ^ bits);
  }
  return key;
}

/// Of elements whose order does not matter.
template <std::size_t N>
Key key_of(std::array<Key, N> keys) {
  std::sort(keys.begin(), keys.end());
  Key all = 0;
  for (Key key : keys) all = mixed(all ^ key);
  return all;
}

constexpr std::array kFlaws{&SurfaceFigures::nonmanifold, &SurfaceFigures::pinches, &SurfaceFigures::flipped,
                            &SurfaceFigures::crossings};

void sort(SurfaceFigures& s) {
  for (const auto flaws : kFlaws) std::sort((s.*flaws).begin(), (s.*flaws).end());
}

/// Vertices of one place made one; faces that are none left out, the others turned over nowhere.
Mesh welded(const Mesh& mesh, SurfaceFigures& s) {
  Mesh out;
  out.vertices = mesh.vertices;
  const std::vector<int> first = first_at_same_place(mesh);
  for (const Triangle& f : mesh.faces) {
    const Triangle t{first[f[0]], first[f[1]], first[f[2]]};
    const bool finite = std::all_of(t.begin(), t.end(), [&](int v) { return mesh.vertices[v].allFinite(); });
    s.nonfinite += !finite;
    if (finite && t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) out.faces.push_back(t);
  }
  return out;
}

/// Pieces, and all that is seen from edge to edge.
void measure_edges(const Mesh& mesh, SurfaceFigures& s) {
  DisjointSets pieces(mesh.face_count());
  DisjointSets fans(3 * mesh.face_count());  // of corners
  const auto corner = [&](int face, int vertex) {
    const Triangle& t = mesh.faces[face];
    return 3 * face + (t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2);
  };
  const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh);
  for_each_mesh_edge(half_edges, [&](auto first, auto last) {
    const int low = first->low(), high = first->high();
    for (auto e = first + 1; e < last; ++e) {
      pieces.unite(first->face, e->face);
      fans.unite(corner(first->face, low), corner(e->face, low));
      fans.unite(corner(first->face, high), corner(e->face, high));
    }
    const bool flipped = last - first == 2 && first->from == first[1].from;
    if (last - first > 2 || flipped)
      (flipped ? s.flipped : s.nonmanifold)
          .push_back(key_of(std::array{key_of(mesh.vertices[low]), key_of(mesh.vertices[high])}));
  });
  std::vector<int> fan(mesh.vertices.size(), -1);  // -2: already counted
  for (int f = 0; f < mesh.face_count(); ++f) {
    s.pieces += pieces.find(f) == f;
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.faces[f][k], set = fans.find(3 * f + k);
      if (fan[v] >= 0 && fan[v] != set) {
        s.pinches.push_back(key_of(mesh.vertices[v]));
        fan[v] = -2;
      }
      if (fan[v] == -1) fan[v] = set;
    }
  }
}

void measure_volume(const Mesh& mesh, const std::vector<Loop>& borders, SurfaceFigures& s) {
  const Box box = mesh.bounds();
  if (box.isEmpty()) return;
  const Vec3 middle = box.center();  // large coordinates cancel
  double area = 0, six = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    area += mesh.area(f);
    six += (mesh.corner(f, 0) - middle).dot((mesh.corner(f, 1) - middle).cross(mesh.corner(f, 2) - middle));
  }
  for (const Loop& border : borders) {
    Vec3 hub = Vec3::Zero();
    for (int v : border) hub += (mesh.vertices[v] - middle) / double(border.size());
    for (int i = 0; i < border.size(); ++i) {
      const Vec3 a = mesh.vertices[border.vertices[i]] - middle, b = mesh.vertices[border.next(i)] - middle;
      six += hub.dot(b.cross(a));
    }
  }
  s.volume = six / 6;
  s.roundest = std::pow(area, 1.5) / (6 * std::sqrt(M_PI));
}

void measure_crossings(const Mesh& mesh, int threads, SurfaceFigures& s) {
  const auto face_key = [&](int f) {
    return key_of(std::array{key_of(mesh.corner(f, 0)), key_of(mesh.corner(f, 1)), key_of(mesh.corner(f, 2))});
  };
  for (const auto& [f, g] : intersecting_faces(mesh, SurfaceFigures::most_crossings, threads))
    s.crossings.push_back(key_of(std::array{face_key(f), face_key(g)}));
}

std::string counted(long n, const char* one, const char* many) {
  return n == 1 ? std::string("1 ") + one : std::to_string(n) + " " + many;
}

/// How many flaws of the result the inputs do not have.
long added(const SurfaceFigures::Flaws& result, const SurfaceFigures::Flaws& inputs, bool by_number) {
  if (by_number) return std::max(0L, long(result.size()) - long(inputs.size()));
  SurfaceFigures::Flaws rest;
  std::set_difference(result.begin(), result.end(), inputs.begin(), inputs.end(), std::back_inserter(rest));
  return long(rest.size());
}

std::string enumerated(const std::vector<std::string>& phrases) {
  std::string text;
  for (std::size_t i = 0; i < phrases.size(); ++i)
    text += (i == 0 ? "" : i + 1 < phrases.size() ? ", " : " and ") + phrases[i];
  return text;
}

/// Encloses something, and not but a sheet's bend: an open surface that is hollow as
/// half a ball, of 1.4 by this measure; a sheet bent by 20 degrees has 0.3.
bool solid(const SurfaceFigures& s, int sign) {
  const double least = s.borders > 0 ? 1 : 0.01;
  return sign * s.volume > least * s.roundest;
}

}  // namespace

SurfaceFigures measure_surface(const Mesh& mesh, int threads) {
  SurfaceFigures s;
  const Mesh surface = welded(mesh, s);
  measure_edges(surface, s);
  const std::vector<Loop> borders = boundary_loops(surface, edge_map(surface));
  s.borders = int(borders.size());
  measure_volume(surface, borders, s);
  measure_crossings(surface, threads, s);
  sort(s);
  return s;
}

SurfaceFigures together(const std::vector<SurfaceFigures>& surfaces) {
  SurfaceFigures all;
  for (const SurfaceFigures& s : surfaces) {
    all.pieces += s.pieces, all.borders += s.borders, all.nonfinite += s.nonfinite;
    all.volume += s.volume, all.roundest += s.roundest;
    for (const auto flaws : kFlaws) (all.*flaws).insert((all.*flaws).end(), (s.*flaws).begin(), (s.*flaws).end());
  }
  sort(all);
  return all;
}

SurfaceFigures measure_parts(const Mesh& mesh, const std::vector<char>& part, int threads) {
  std::vector<SurfaceFigures> figures;
  for (const char one : std::set<char>(part.begin(), part.end())) {
    std::vector<char> of_it;
    for (const char p : part) of_it.push_back(p == one);
    figures.push_back(measure_surface(take_faces(mesh, of_it), threads));
  }
  return together(figures);
}

void add_flaws(const SurfaceFigures& from, SurfaceFigures& to) {
  for (const auto flaws : kFlaws) {
    SurfaceFigures::Flaws both;
    std::set_union((from.*flaws).begin(), (from.*flaws).end(), (to.*flaws).begin(), (to.*flaws).end(),
                   std::back_inserter(both));
    to.*flaws = std::move(both);
  }
}

std::string worse_than_inputs(const SurfaceFigures& result, const std::vector<SurfaceFigures>& inputs,
                              const ResultRules& rules) {
  const SurfaceFigures before = together(inputs);
  std::vector<std::string> worse;
  const auto flaws = [&](SurfaceFigures::Flaws SurfaceFigures::*which, const char* one, const char* many) {
    const SurfaceFigures::Flaws &now = result.*which, &then = before.*which;
    const bool cut_short = long(std::max(now.size(), then.size())) >= SurfaceFigures::most_crossings;
    if (const long n = added(now, then, rules.moved || cut_short)) worse.push_back(counted(n, one, many));
  };
  if (result.nonfinite > before.nonfinite)
    worse.push_back(counted(result.nonfinite, "face", "faces") + " with a coordinate that is no number");
  const int pieces = before.pieces - (rules.joins ? int(inputs.size()) - 1 : 0);
  if (!rules.may_part && !inputs.empty() && result.pieces > pieces)
    worse.push_back(counted(result.pieces, "piece", "pieces") + " where " + std::to_string(pieces) + " would do");
  if (!rules.may_open && result.borders > before.borders)
    worse.push_back(counted(result.borders - before.borders, "open border", "open borders"));
  flaws(&SurfaceFigures::nonmanifold, "edge of more than two faces", "edges of more than two faces");
  if (!rules.may_open)
    flaws(&SurfaceFigures::pinches, "vertex in which it touches itself", "vertices in which it touches itself");
  flaws(&SurfaceFigures::flipped, "edge between faces that look opposite ways",
        "edges between faces that look opposite ways");
  flaws(&SurfaceFigures::crossings, "pair of crossing faces", "pairs of crossing faces");
  const bool was_solid = std::all_of(inputs.begin(), inputs.end(), [](const auto& s) { return solid(s, 1); });
  if (!inputs.empty() && was_solid && solid(result, -1)) worse.push_back("its inside out");
  return enumerated(worse);
}

void check_arrays(const Mesh& mesh) {
  const auto same = [](std::size_t length, std::size_t expected, const char* what) {
    if (length != 0 && length != expected)
      throw std::logic_error("a result with " + std::to_string(length) + " " + what + " of " +
                             std::to_string(expected) + " elements");
  };
  const std::size_t vertices = mesh.vertices.size(), faces = mesh.faces.size();
  same(mesh.vertex_normal.size(), vertices, "normals");
  same(mesh.vertex_color.size(), vertices, "vertex colours");
  same(mesh.vertex_quality.size(), vertices, "vertex qualities");
  same(mesh.vertex_selected.size(), vertices, "vertex marks");
  same(mesh.face_color.size(), faces, "face colours");
  same(mesh.face_quality.size(), faces, "face qualities");
  same(mesh.face_selected.size(), faces, "face marks");
  same(mesh.wedges.size(), faces, "texture coordinates");
  for (const Triangle& f : mesh.faces)
    for (int v : f)
      if (v < 0 || v >= mesh.vertex_count()) throw std::logic_error("a face without its vertex");
  for (const Wedges& w : mesh.wedges)
    if (w.texture >= int(mesh.textures.size())) throw std::logic_error("a face without its texture");
}

Mesh in_single_precision(Mesh mesh) {
  for (Vec3& p : mesh.vertices)
    for (int k = 0; k < 3; ++k) {
      volatile float kept =
          float(p[k]);  // else GCC 12 leaves the rounding of two neighbours out (-ftree-slp-vectorize)
      p[k] = double(kept);
    }
  return mesh;
}

}  // namespace parts::mesh
