// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/layers.h"

#include <vcg/complex/algorithms/clean.h>

#include <Eigen/LU>
#include <cmath>

#include "host_api.h"
#include "parts/host/filter.h"
#include "parts/host/sizes.h"

namespace parts::host {

namespace {

using Point = CMeshO::CoordType;
using Scalar = CMeshO::ScalarType;

Eigen::Matrix4d to_eigen(const Matrix44m& m) {
  Eigen::Matrix4d out;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) out(r, c) = m.ElementAt(r, c);
  return out;
}

Point to_point(const Vec3& p) { return Point(Scalar(p.x()), Scalar(p.y()), Scalar(p.z())); }
Vec3 to_vec(const Point& p) { return Vec3(p.X(), p.Y(), p.Z()); }
Color to_color(const vcg::Color4b& c) { return {c[0], c[1], c[2], c[3]}; }
vcg::Color4b to_color(const Color& c) { return vcg::Color4b(c[0], c[1], c[2], c[3]); }

/// A layer's matrix, ready for positions and normals.
struct Placing {
  explicit Placing(const Eigen::Matrix4d& m)
      : matrix(m), identity(m == Eigen::Matrix4d::Identity()), mirrors(m.topLeftCorner<3, 3>().determinant() < 0) {
    // The cofactors transform normals, also where the matrix has no inverse.
    const Eigen::Matrix3d a = m.topLeftCorner<3, 3>();
    for (int c = 0; c < 3; ++c) normals.col(c) = a.col((c + 1) % 3).cross(a.col((c + 2) % 3));
    if (mirrors) normals = -normals;
  }
  Vec3 position(const Vec3& p) const { return identity ? p : Vec3((matrix * p.homogeneous()).hnormalized()); }
  Eigen::Vector3f normal(const Vec3& n) const {
    return (identity ? n : Vec3((normals * n).stableNormalized())).cast<float>();
  }

  Eigen::Matrix4d matrix;
  Eigen::Matrix3d normals;
  bool identity, mirrors;
};

void read_vertices(const MeshModel& layer, const Placing& placing, Mesh& out, std::vector<int>& index) {
  const CMeshO& m = layer.cm;
  const bool colors = layer.hasDataMask(MeshModel::MM_VERTCOLOR);
  const bool qualities = layer.hasDataMask(MeshModel::MM_VERTQUALITY);
  index.assign(m.vert.size(), -1);
  out.vertices.reserve(m.vn), out.vertex_normal.reserve(m.vn);
  bool selected = false;
  for (size_t i = 0; i < m.vert.size(); ++i) {
    const CVertexO& v = m.vert[i];
    if (v.IsD()) continue;
    index[i] = out.vertex_count();
    out.vertices.push_back(placing.position(to_vec(v.cP())));
    out.vertex_normal.push_back(placing.normal(to_vec(v.cN())));
    if (colors) out.vertex_color.push_back(to_color(v.cC()));
    if (qualities) out.vertex_quality.push_back(v.cQ());
    out.vertex_selected.push_back(v.IsS());
    selected |= v.IsS();
  }
  if (!selected) out.vertex_selected.clear();
}

Wedges read_wedges(const CFaceO& f, bool per_wedge, int textures) {
  Wedges w;
  int texture = -1;
  for (int k = 0; k < 3; ++k) {
    const auto& t = per_wedge ? f.cWT(k) : f.cV(k)->cT();
    w.uv[k] = {t.U(), t.V()};
    if (k == 0) texture = t.N();
  }
  w.texture = texture < textures ? texture : -1;
  return w;
}

void read_faces(const MeshModel& layer, const Placing& placing, const std::vector<int>& index, Mesh& out) {
  const CMeshO& m = layer.cm;
  const bool colors = layer.hasDataMask(MeshModel::MM_FACECOLOR);
  const bool qualities = layer.hasDataMask(MeshModel::MM_FACEQUALITY);
  const bool per_wedge = layer.hasDataMask(MeshModel::MM_WEDGTEXCOORD);
  const bool textured = per_wedge || layer.hasDataMask(MeshModel::MM_VERTTEXCOORD);
  bool selected = false;
  out.faces.reserve(m.fn);
  for (const CFaceO& f : m.face) {
    if (f.IsD()) continue;
    Triangle t;
    for (int k = 0; k < 3; ++k) t[k] = index[vcg::tri::Index(m, f.cV(k))];
    if (textured) out.wedges.push_back(read_wedges(f, per_wedge, int(m.textures.size())));
    if (placing.mirrors) {
      std::swap(t[1], t[2]);
      if (textured) std::swap(out.wedges.back().uv[1], out.wedges.back().uv[2]);
    }
    out.faces.push_back(t);
    if (colors) out.face_color.push_back(to_color(f.cC()));
    if (qualities) out.face_quality.push_back(f.cQ());
    out.face_selected.push_back(f.IsS());
    selected |= f.IsS();
  }
  if (!selected) out.face_selected.clear();
  if (textured)
    for (const std::string& name : m.textures) out.textures.push_back(api::texture_file(layer, name));
}

}  // namespace

std::string Layer::name() const { return model_->label().toStdString(); }

Mesh Layer::mesh() const {
  Mesh mesh = read_layer(*model_);
  check_sizes(mesh, coordinate_step(*model_), name());
  return mesh;
}

Mesh read_layer(const MeshModel& layer) {
  const Placing placing(to_eigen(layer.cm.Tr));
  Mesh out;
  std::vector<int> index;
  read_vertices(layer, placing, out, index);
  read_faces(layer, placing, index, out);
  return out;
}

Box layer_box(const MeshModel& layer) {
  const Placing placing(to_eigen(layer.cm.Tr));
  Box box;
  for (const CVertexO& v : layer.cm.vert) {
    if (v.IsD()) continue;
    const Vec3 p = placing.position(to_vec(v.cP()));
    if (p.allFinite()) box.extend(p);
  }
  return box;
}

double coordinate_step(const MeshModel& layer) {
  const Eigen::Matrix3d linear = to_eigen(layer.cm.Tr).topLeftCorner<3, 3>();
  Scalar largest = 0;
  for (const CFaceO& f : layer.cm.face)
    for (int k = 0; k < 3 && !f.IsD(); ++k)
      for (int c = 0; c < 3; ++c)
        if (const Scalar x = std::abs(f.cV(k)->cP()[c]); std::isfinite(x)) largest = std::max(largest, x);
  return coordinate_step_at(largest) * linear.colwise().norm().maxCoeff();
}

void write_layer(const Mesh& mesh, MeshModel& layer) {
  CMeshO& m = layer.cm;
  int mask = MeshModel::MM_NONE;
  if (!mesh.vertex_color.empty()) mask |= MeshModel::MM_VERTCOLOR;
  if (!mesh.vertex_quality.empty()) mask |= MeshModel::MM_VERTQUALITY;
  if (!mesh.face_color.empty()) mask |= MeshModel::MM_FACECOLOR;
  if (!mesh.face_quality.empty()) mask |= MeshModel::MM_FACEQUALITY;
  if (!mesh.wedges.empty()) mask |= MeshModel::MM_WEDGTEXCOORD;
  layer.updateDataMask(mask);

  vcg::tri::Allocator<CMeshO>::AddVertices(m, mesh.vertices.size());
  for (int i = 0; i < mesh.vertex_count(); ++i) {
    CVertexO& v = m.vert[i];
    v.P() = to_point(mesh.vertices[i]);
    if (!mesh.vertex_color.empty()) v.C() = to_color(mesh.vertex_color[i]);
    if (!mesh.vertex_quality.empty()) v.Q() = mesh.vertex_quality[i];
    if (!mesh.vertex_selected.empty() && mesh.vertex_selected[i]) v.SetS();
  }
  vcg::tri::Allocator<CMeshO>::AddFaces(m, mesh.faces.size());
  for (int i = 0; i < mesh.face_count(); ++i) {
    CFaceO& f = m.face[i];
    for (int k = 0; k < 3; ++k) {
      f.V(k) = &m.vert[mesh.faces[i][k]];
      if (mesh.wedges.empty()) continue;
      f.WT(k).P() = vcg::Point2f(mesh.wedges[i].uv[k].x(), mesh.wedges[i].uv[k].y());
      f.WT(k).N() = short(mesh.wedges[i].texture);
    }
    if (!mesh.face_color.empty()) f.C() = to_color(mesh.face_color[i]);
    if (!mesh.face_quality.empty()) f.Q() = mesh.face_quality[i];
    if (!mesh.face_selected.empty() && mesh.face_selected[i]) f.SetS();
  }
  m.svn = int(vcg::tri::UpdateSelection<CMeshO>::VertexCount(m));
  m.sfn = int(vcg::tri::UpdateSelection<CMeshO>::FaceCount(m));
  api::update_box_and_normals(layer);
  vcg::tri::UpdateNormal<CMeshO>::NormalizePerVertex(m);
  for (size_t i = 0; i < mesh.vertex_normal.size(); ++i) m.vert[i].N() = to_point(mesh.vertex_normal[i].cast<double>());
  layer.setMeshModified();
}

void place_layer(const Eigen::Matrix4d& matrix, bool to_vertices, MeshModel& layer) {
  CMeshO& m = layer.cm;
  const Placing placing(matrix * to_eigen(m.Tr));
  if (!to_vertices) {
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) m.Tr.ElementAt(r, c) = Scalar(placing.matrix(r, c));
    return;
  }
  for (CVertexO& v : m.vert) {
    if (v.IsD()) continue;
    v.P() = to_point(placing.position(to_vec(v.cP())));
    v.N() = to_point(placing.normal(to_vec(v.cN())).cast<double>());
  }
  m.Tr.SetIdentity();
  if (placing.mirrors) {
    vcg::tri::Clean<CMeshO>::FlipMesh(m);
    layer.updateDataMask(layer.dataMask() & (MeshModel::MM_FACEFACETOPO | MeshModel::MM_VERTFACETOPO));
  }
  vcg::tri::UpdateBounding<CMeshO>::Box(m);
  vcg::tri::UpdateNormal<CMeshO>::PerFaceNormalized(m);
  layer.setMeshModified();
}

}  // namespace parts::host
