// SPDX-License-Identifier: GPL-3.0-or-later
// Where a surface is closest, and where it crosses itself: ours beside CGAL,
// Embree and vcglib, each on one thread.

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <embree3/rtcore.h>
#include <vcg/complex/complex.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "bench/measure.h"
#include "bench/scenes.h"
#include "parts/mesh/self_intersections.h"
#include "parts/spatial/closest_point.h"
#include "parts/spatial/triangle.h"
#include "vcg/complex/algorithms/closest.h"
#include "vcg/complex/algorithms/update/bounding.h"
#include "vcg/complex/algorithms/update/normal.h"
#include "vcg/space/index/grid_static_ptr.h"

using namespace parts;
using namespace parts::bench;

namespace {

/// What answers how far a point is from a mesh.
class Rival {
 public:
  virtual ~Rival() = default;
  virtual double distance(const Vec3& p) = 0;
};

class Ours : public Rival {
 public:
  explicit Ours(const Mesh& mesh, bool hints) : hints_(hints) {
    spatial::Surface surface;
    for (int f = 0; f < mesh.face_count(); ++f) {
      surface.triangles.push_back({mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)});
      surface.normals.push_back(mesh.normal(f));
    }
    tree_ = std::make_unique<spatial::TriangleTree>(surface);
  }
  double distance(const Vec3& p) override {
    if (!hints_) hint_ = 0;
    return (tree_->closest(p, hint_).point - p).norm();
  }

 private:
  bool hints_;
  int hint_ = 0;
  std::unique_ptr<spatial::TriangleTree> tree_;
};

template <class Kernel>
CGAL::Surface_mesh<typename Kernel::Point_3> cgal_surface(const Mesh& mesh) {
  CGAL::Surface_mesh<typename Kernel::Point_3> surface;
  std::vector<CGAL::SM_Vertex_index> at;
  for (const Vec3& p : mesh.vertices) at.push_back(surface.add_vertex({p[0], p[1], p[2]}));
  for (const Triangle& f : mesh.faces) surface.add_face(at[f[0]], at[f[1]], at[f[2]]);
  return surface;
}

class Cgal : public Rival {
 public:
  explicit Cgal(const Mesh& mesh) : surface_(cgal_surface<Kernel>(mesh)) {
    tree_.insert(faces(surface_).first, faces(surface_).second, surface_);
    tree_.build();
    tree_.accelerate_distance_queries();
  }
  double distance(const Vec3& p) override {
    return std::sqrt(tree_.squared_distance(Kernel::Point_3(p[0], p[1], p[2])));
  }

 private:
  using Kernel = CGAL::Simple_cartesian<double>;
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  Surface surface_;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Surface>>> tree_;
};

/// Embree finds the boxes; what is closest in them is asked of the same function as ours.
class Embree : public Rival {
 public:
  explicit Embree(const Mesh& mesh) : mesh_(mesh), device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
    for (const Vec3& p : mesh.vertices)
      for (int d = 0; d < 3; ++d) *points++ = float(p[d]);
    auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh.faces.size()));
    for (const Triangle& f : mesh.faces)
      for (int k = 0; k < 3; ++k) *corners++ = unsigned(f[k]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  double distance(const Vec3& p) override {
    RTCPointQuery query{float(p[0]), float(p[1]), float(p[2]), 0, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    Asked asked{mesh_, p};
    rtcPointQuery(scene_, &query, &context, closer, &asked);
    return asked.least;
  }

 private:
  struct Asked {
    const Mesh& mesh;
    Vec3 p;
    double least = std::numeric_limits<double>::infinity();
  };
  static bool closer(RTCPointQueryFunctionArguments* arguments) {
    Asked& asked = *static_cast<Asked*>(arguments->userPtr);
    const int f = int(arguments->primID);
    const Vec3 q = spatial::closest_on_triangle(
        {asked.mesh.corner(f, 0), asked.mesh.corner(f, 1), asked.mesh.corner(f, 2)}, asked.p);
    const double distance = (q - asked.p).norm();
    if (distance >= asked.least) return false;
    asked.least = distance;
    arguments->query->radius = float(distance);
    return true;  // the radius has changed
  }

  const Mesh& mesh_;
  RTCDevice device_;
  RTCScene scene_;
};

class VcgVertex;
class VcgFace;
struct VcgTypes : vcg::UsedTypes<vcg::Use<VcgVertex>::AsVertexType, vcg::Use<VcgFace>::AsFaceType> {};
class VcgVertex : public vcg::Vertex<VcgTypes, vcg::vertex::Coord3d, vcg::vertex::Normal3d, vcg::vertex::BitFlags> {};
class VcgFace
    : public vcg::Face<VcgTypes, vcg::face::VertexRef, vcg::face::Normal3d, vcg::face::Mark, vcg::face::BitFlags> {};
class VcgMesh : public vcg::tri::TriMesh<std::vector<VcgVertex>, std::vector<VcgFace>> {};

/// vcglib's uniform grid.
class Vcg : public Rival {
 public:
  explicit Vcg(const Mesh& mesh) {
    auto v = vcg::tri::Allocator<VcgMesh>::AddVertices(mesh_, mesh.vertices.size());
    for (const Vec3& p : mesh.vertices) (v++)->P() = {p[0], p[1], p[2]};
    auto f = vcg::tri::Allocator<VcgMesh>::AddFaces(mesh_, mesh.faces.size());
    for (const Triangle& t : mesh.faces) {
      for (int k = 0; k < 3; ++k) f->V(k) = &mesh_.vert[t[k]];
      ++f;
    }
    vcg::tri::UpdateBounding<VcgMesh>::Box(mesh_);
    vcg::tri::UpdateNormal<VcgMesh>::PerFaceNormalized(mesh_);
    grid_.Set(mesh_.face.begin(), mesh_.face.end());
  }
  double distance(const Vec3& p) override {
    double least = 0;
    vcg::Point3d closest;
    vcg::tri::GetClosestFaceBase(mesh_, grid_, vcg::Point3d(p[0], p[1], p[2]), 2 * mesh_.bbox.Diag(), least, closest);
    return std::abs(least);
  }

 private:
  VcgMesh mesh_;
  vcg::GridStaticPtr<VcgFace, double> grid_;
};

/// Points along the surface, each a little off it, as a registration asks; or anywhere around it.
std::vector<Vec3> queries(const Mesh& mesh, int count, bool near) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> at(-1, 1);
  const Box box = mesh.bounds();
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const Vec3 offset(at(random), at(random), at(random));
    if (near)
      points.push_back(mesh.vertices[long(i) * mesh.vertex_count() / count] + 0.01 * box.diagonal().norm() * offset);
    else
      points.push_back(box.center() + box.sizes().cwiseProduct(offset));
  }
  return points;
}

double asked(Rival& rival, const std::vector<Vec3>& points, std::vector<double>& distances) {
  distances.resize(points.size());
  const Times times = best_of([&] {
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = rival.distance(points[i]);
  });
  return times.cpu / double(points.size()) * 1e6;
}

void closest(const Mesh& mesh) {
  Table table("Closest point, " + bench::count(mesh.face_count()) + " faces, one thread, processor time",
              {"Index", "Build ms", "Near the surface, µs", "Anywhere, µs", "Greatest difference of distances"});
  const std::vector<Vec3> near = queries(mesh, 20000, true), far = queries(mesh, 5000, false);
  std::vector<double> truth_near, truth_far;
  const auto row = [&](const char* name, const std::function<std::unique_ptr<Rival>()>& make) {
    std::unique_ptr<Rival> rival;
    const Times build = best_of([&] { rival = make(); }, 3);
    std::vector<double> near_distances, far_distances;
    const double near_time = asked(*rival, near, near_distances), far_time = asked(*rival, far, far_distances);
    if (truth_near.empty()) truth_near = near_distances, truth_far = far_distances;
    double worst = 0;
    for (std::size_t i = 0; i < near.size(); ++i) worst = std::max(worst, std::abs(near_distances[i] - truth_near[i]));
    for (std::size_t i = 0; i < far.size(); ++i) worst = std::max(worst, std::abs(far_distances[i] - truth_far[i]));
    table.row({name, text(build.cpu * 1e3), text(near_time), text(far_time),
               text(worst / mesh.bounds().diagonal().norm(), 2)});
  };
  row("TriangleTree", [&] { return std::make_unique<Ours>(mesh, false); });
  row("TriangleTree, with hints", [&] { return std::make_unique<Ours>(mesh, true); });
  row("CGAL AABB tree", [&] { return std::make_unique<Cgal>(mesh); });
  row("Embree 3 point query", [&] { return std::make_unique<Embree>(mesh); });
  row("vcglib uniform grid", [&] { return std::make_unique<Vcg>(mesh); });
  table.note("Differences as shares of the box's diagonal. Embree keeps its boxes in single precision.");
}

/// Both models of a scene as one mesh: where they cross, it crosses itself.
Mesh both(const Scene& scene) {
  Mesh mesh = scene.a.mesh;
  const int first = mesh.vertex_count();
  mesh.vertices.insert(mesh.vertices.end(), scene.b.mesh.vertices.begin(), scene.b.mesh.vertices.end());
  for (const Triangle& f : scene.b.mesh.faces) mesh.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  return mesh;
}

void crossings(int faces) {
  Table table("Faces that cross, one thread, processor time",
              {"Mesh", "Faces", "Ours: pairs", "ms", "CGAL: pairs", "ms", "CGAL / ours"});
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  for (const Scene& scene : {two_spheres(faces), two_creatures(faces)})
    for (const bool crossing : {false, true}) {
      const Mesh mesh = crossing ? both(scene) : scene.a.mesh;
      std::size_t found = 0;
      const Times ours = best_of([&] { found = mesh::intersecting_faces(mesh, 0, 1).size(); });
      const auto surface = cgal_surface<Kernel>(mesh);
      std::vector<std::pair<CGAL::SM_Face_index, CGAL::SM_Face_index>> pairs;
      const Times theirs = best_of([&] {
        pairs.clear();
        CGAL::Polygon_mesh_processing::self_intersections(surface, std::back_inserter(pairs));
      });
      table.row({scene.name + (crossing ? ", both" : ", one"), bench::count(mesh.face_count()),
                 bench::count(double(found)), text(ours.cpu * 1e3), bench::count(double(pairs.size())),
                 text(theirs.cpu * 1e3), ratio(theirs.cpu / ours.cpu)});
    }
}

}  // namespace

int main() {
  for (int faces : {20000, 500000}) closest(two_creatures(faces).a.mesh);
  crossings(100000);
}
