// SPDX-License-Identifier: GPL-3.0-or-later
//
// compose_fuzz [FROM [TO]]: composes small random scenes that nobody prepared.
// Each must give a sane result or a UserError; anything else ends the program
// with the seed on its last line.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "parts/compose/compose.h"
#include "support/shapes.h"

namespace parts::test {
namespace {

Mesh random_shape(Random& random) {
  switch (random.below(6)) {
    case 0:
      return sphere(Vec3::Zero(), 1, random.below(3));
    case 1:
      return torus(Vec3::Zero(), 0.8, 0.3, 8 + random.below(12), 4 + random.below(8));
    case 2:
      return box(Vec3::Constant(-0.8), Vec3::Constant(0.8), 1 + random.below(4));
    case 3:
      return noisy_sphere(Vec3::Zero(), 1, 2, 0.9, unsigned(random.below(1000)));
    case 4:
      return together({sphere({-0.5, 0, 0}, 0.7, 1), sphere({0.5, 0, 0}, 0.7, 1)});
    default: {  // triangles that have nothing to do with each other
      Mesh soup;
      for (int v = 0; v < 30; ++v) soup.vertices.push_back(random.direction() * random.uniform(0, 1));
      for (int f = 0; f < 40; ++f) soup.faces.push_back({random.below(30), random.below(30), random.below(30)});
      return soup;
    }
  }
}

void spoil(Mesh& mesh, Random& random) {
  for (int n = random.below(8); n > 0 && !mesh.faces.empty(); --n) {
    const int f = random.below(mesh.face_count()), v = random.below(mesh.vertex_count());
    switch (random.below(8)) {
      case 0:
        std::swap(mesh.faces[f][0], mesh.faces[f][1]);
        break;
      case 1:
        mesh.faces.erase(mesh.faces.begin() + f);
        break;
      case 2:
        mesh.faces.push_back(mesh.faces[f]);
        break;
      case 3:
        mesh.faces[f][random.below(3)] = v;
        break;
      case 4:
        mesh.vertices[v] = mesh.vertices[random.below(mesh.vertex_count())];
        break;
      case 5:
        mesh.vertices[v][random.below(3)] = std::numeric_limits<double>::quiet_NaN();
        break;
      case 6:
        mesh.vertices[v] *= std::pow(10., random.uniform(-3, 3));
        break;
      default:
        mesh.vertices[v][random.below(3)] = std::round(mesh.vertices[v][random.below(3)]);
    }
  }
}

void dress(Mesh& mesh, Random& random) {
  if (random.below(2)) mesh.vertex_color.assign(mesh.vertices.size(), {1, 2, 3, 4});
  if (random.below(2)) mesh.vertex_normal.assign(mesh.vertices.size(), {0, 0, 1});
  if (random.below(2)) mesh.face_quality.assign(mesh.faces.size(), 1.f);
  if (random.below(2)) {
    mesh.textures = {"t.png"};
    mesh.wedges.resize(mesh.faces.size());
    for (Wedges& w : mesh.wedges) w.texture = random.below(2) - 1;
  }
}

cut::Part random_part(Random& random) {
  cut::Part part{random_shape(random), {}};
  spoil(part.mesh, random);
  dress(part.mesh, random);
  const Vec3 towards = random.direction();
  const double beyond = random.uniform(-0.2, 1);
  part.keep = faces_where(part.mesh, [&](const Vec3& c) { return c.dot(towards) > beyond; });
  return part;
}

compose::ComposeOptions random_options(Random& random) {
  compose::ComposeOptions o;
  o.resolution = random.below(4) ? 1 + random.below(40) : 0;
  o.cut = random.below(2) ? cut::Cut::Thesis : cut::Cut::Mesh;
  o.stitch = random.below(5) > 0;
  o.transition_surface = random.below(2);
  o.threads = 1 + random.below(3);
  o.smoothing.iterations = random.below(6);
  o.smoothing.weight = random.uniform(0, 1);
  o.smoothing.distance = random.below(2) ? random.uniform(0, 1) : 0;
  if (random.below(3) == 0)
    for (int n = 0; n < 2; ++n) o.volume.extend(random.direction() * random.uniform(0.2, 2));
  return o;
}

template <class T>
bool fits(const std::vector<T>& attribute, std::size_t count) {
  return attribute.empty() || attribute.size() == count;
}

bool sane(const Mesh& m) {
  for (const Triangle& t : m.faces)
    for (int v : t)
      if (v < 0 || v >= m.vertex_count() || !m.vertices[v].allFinite()) return false;
  for (const Wedges& w : m.wedges)
    if (w.texture < -1 || w.texture >= int(m.textures.size())) return false;
  const std::size_t v = m.vertices.size(), f = m.faces.size();
  return fits(m.vertex_color, v) && fits(m.vertex_normal, v) && fits(m.face_quality, f) && fits(m.wedges, f);
}

bool survives(unsigned seed, bool& refused) {
  Random random(seed);
  const double scale = random.below(4) ? 1 : std::pow(10., random.uniform(-6, 6));
  cut::Part a = random_part(random), b = random_part(random);
  const Vec3 shift = random.direction() * random.uniform(0, 1.5);
  for (Vec3& v : b.mesh.vertices) v += shift;
  compose::ComposeOptions options = random_options(random);
  for (cut::Part* p : {&a, &b})
    for (Vec3& v : p->mesh.vertices) v *= scale;
  if (!options.volume.isEmpty()) options.volume.min() *= scale, options.volume.max() *= scale;
  try {
    Progress silent;
    const compose::ComposeResult r = compose::compose(a, b, options, silent);
    return sane(r.composed) && sane(r.clipped_a) && sane(r.clipped_b) && sane(r.transition) &&
           r.face_from_b.size() == r.composed.faces.size();
  } catch (const UserError&) {
    refused = true;
    return true;
  } catch (const std::exception& e) {
    std::printf("%s\n", e.what());
    return false;
  }
}

}  // namespace
}  // namespace parts::test

int main(int argc, char** argv) {
  const unsigned from = argc > 1 ? unsigned(std::atoi(argv[1])) : 0;
  const unsigned to = argc > 2 ? unsigned(std::atoi(argv[2])) : from + 100;
  unsigned refusals = 0;
  for (unsigned seed = from; seed < to; ++seed) {
    std::printf("seed %u\r", seed);
    std::fflush(stdout);
    bool refused = false;
    if (!parts::test::survives(seed, refused)) {
      std::printf("seed %u: neither a sane result nor a UserError\n", seed);
      return 1;
    }
    refusals += refused;
  }
  std::printf("%u scenes: %u composed, %u refused with a sentence\n", to - from, to - from - refusals, refusals);
}
