// SPDX-License-Identifier: GPL-3.0-or-later
// Layers to meshes and back.
#include <gtest/gtest.h>

#include "host_api.h"
#include "parts/host/layers.h"
#include "parts/mesh/result_check.h"

namespace parts::host {
namespace {

/// Two triangles with every attribute, and a vertex without faces.
Mesh square() {
  Mesh m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {5, 5, 5}};
  m.faces = {{0, 1, 2}, {0, 2, 3}};
  m.vertex_normal.assign(5, Eigen::Vector3f(0, 0, 1));
  for (std::uint8_t i = 0; i < 5; ++i) m.vertex_color.push_back({i, 2, 3, 255});
  m.vertex_quality = {0, 1, 2, 3, 4};
  m.face_color = {{10, 0, 0, 255}, {20, 0, 0, 255}};
  m.face_quality = {0.5f, 0.25f};
  m.wedges.resize(2);
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k) m.wedges[f].uv[k] = {0.125f * k, 0.5f * f};
  m.wedges[0].texture = 0, m.wedges[1].texture = -1;
  m.vertex_selected = {1, 0, 0, 0, 1};
  m.face_selected = {0, 1};
  return m;
}

MeshModel* add(MeshDocument& document, const Mesh& mesh) {
  MeshModel* layer = document.addNewMesh("", "layer");
  write_layer(mesh, *layer);
  return layer;
}

Matrix44m matrix(std::initializer_list<float> values) {
  Matrix44m m;
  int i = 0;
  for (float v : values) m.ElementAt(i / 4, i % 4) = v, ++i;
  return m;
}

TEST(Layers, EveryAttributeComesBack) {
  MeshDocument document;
  const Mesh in = square();
  MeshModel* layer = add(document, in);
  layer->cm.textures = {"a.png"};
  const Mesh out = read_layer(*layer);
  EXPECT_EQ(out.vertices, in.vertices);
  EXPECT_EQ(out.faces, in.faces);
  EXPECT_EQ(out.vertex_normal, in.vertex_normal);
  EXPECT_EQ(out.vertex_color, in.vertex_color);
  EXPECT_EQ(out.vertex_quality, in.vertex_quality);
  EXPECT_EQ(out.face_color, in.face_color);
  EXPECT_EQ(out.face_quality, in.face_quality);
  EXPECT_EQ(out.vertex_selected, in.vertex_selected);
  EXPECT_EQ(out.face_selected, in.face_selected);
  for (int f = 0; f < 2; ++f) {
    EXPECT_EQ(out.wedges[f].uv, in.wedges[f].uv);
    EXPECT_EQ(out.wedges[f].texture, in.wedges[f].texture);
  }
  EXPECT_EQ(out.textures.size(), 1u) << "see test_textures.cpp";
}

TEST(Layers, AttributesThatAMeshLacksStayOff) {
  MeshDocument document;
  Mesh bare;
  bare.vertices = square().vertices;
  bare.faces = square().faces;
  MeshModel* layer = add(document, bare);
  EXPECT_FALSE(layer->hasDataMask(MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTQUALITY | MeshModel::MM_FACECOLOR |
                                  MeshModel::MM_FACEQUALITY | MeshModel::MM_WEDGTEXCOORD));
  const Mesh out = read_layer(*layer);
  EXPECT_TRUE(out.vertex_color.empty() && out.wedges.empty() && out.face_selected.empty());
  EXPECT_EQ(out.vertex_normal[0], Eigen::Vector3f(0, 0, 1)) << "computed";
}

TEST(Layers, CoordinatesAreExactUnderTheIdentity) {
  MeshDocument document;
  Mesh m = square();
  for (Vec3& p : m.vertices) p = p * 0.1 + Vec3::Constant(1e6);
  EXPECT_EQ(read_layer(*add(document, m)).vertices, mesh::in_single_precision(m).vertices);
}

TEST(Layers, TheMatrixIsHonoured) {
  MeshDocument document;
  MeshModel* layer = add(document, square());
  layer->cm.Tr = matrix({0, -2, 0, 10, 2, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1});
  const Mesh out = read_layer(*layer);
  EXPECT_EQ(out.vertices[1], Vec3(10, 2, 0));
  EXPECT_EQ(out.vertex_normal[1], Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(out.faces, square().faces);
  EXPECT_EQ(layer_box(*layer).max(), Vec3(10, 10, 10));
}

TEST(Layers, AMirroringMatrixFlipsFacesAndWedges) {
  MeshDocument document;
  MeshModel* layer = add(document, square());
  layer->cm.Tr = matrix({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1});
  const Mesh out = read_layer(*layer);
  EXPECT_EQ(out.faces[0], (Triangle{0, 2, 1}));
  EXPECT_EQ(out.wedges[0].uv[1], square().wedges[0].uv[2]);
  EXPECT_EQ(out.vertex_normal[0], Eigen::Vector3f(0, 0, -1)) << "still outward";
}

TEST(Layers, DeletedElementsAreSkipped) {
  MeshDocument document;
  MeshModel* layer = add(document, square());
  vcg::tri::Allocator<CMeshO>::DeleteFace(layer->cm, layer->cm.face[0]);
  vcg::tri::Allocator<CMeshO>::DeleteVertex(layer->cm, layer->cm.vert[1]);
  const Mesh out = read_layer(*layer);
  EXPECT_EQ(out.vertex_count(), 4);
  ASSERT_EQ(out.face_count(), 1);
  EXPECT_EQ(out.faces[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(out.face_quality, std::vector<float>{0.25f});
  EXPECT_EQ(out.vertex_quality[1], 2);
}

TEST(Layers, CoordinatesOfVerticesBecomeWedges) {
  MeshDocument document;
  Mesh m = square();
  m.wedges.clear();
  MeshModel* layer = add(document, m);
  layer->cm.textures = {"a.png"};
  layer->updateDataMask(MeshModel::MM_VERTTEXCOORD);
  for (size_t i = 0; i < 5; ++i) {
    layer->cm.vert[i].T().P() = vcg::Point2f(0.125f * i, 1);
    layer->cm.vert[i].T().N() = 0;
  }
  const Mesh out = read_layer(*layer);
  EXPECT_EQ(out.wedges[1].uv[2], Eigen::Vector2f(0.375f, 1));
  EXPECT_EQ(out.wedges[1].texture, 0);
}

TEST(Layers, PointCloudsAndEmptyLayersHaveNoFaces) {
  MeshDocument document;
  Mesh cloud;
  cloud.vertices = square().vertices;
  EXPECT_EQ(read_layer(*add(document, cloud)).vertex_count(), 5);
  EXPECT_EQ(read_layer(*add(document, Mesh())).vertex_count(), 0);
  EXPECT_TRUE(layer_box(*document.mm()).isEmpty());
}

TEST(Layers, PlacingTheMatrixOrTheVerticesLooksTheSame) {
  for (const bool mirror : {false, true}) {
    MeshDocument document;
    Eigen::Matrix4d move = Eigen::Matrix4d::Identity();
    move(0, 0) = mirror ? -2 : 2, move(1, 3) = 7;
    MeshModel *a = add(document, square()), *b = add(document, square());
    a->cm.Tr = b->cm.Tr = matrix({0, -1, 0, 0, 1, 0, 0, 3, 0, 0, 1, 0, 0, 0, 0, 1});
    place_layer(move, false, *a);
    place_layer(move, true, *b);
    EXPECT_TRUE(b->cm.Tr == Matrix44m::Identity());
    EXPECT_EQ(a->cm.vert[1].P(), Point3m(1, 0, 0));
    const Mesh ma = read_layer(*a), mb = read_layer(*b);
    EXPECT_EQ(ma.vertices, mb.vertices);
    EXPECT_EQ(ma.vertices[1], Vec3(0, 11, 0));
    // The host flips by swapping another pair of corners.
    EXPECT_EQ(ma.faces[0], (mirror ? Triangle{0, 2, 1} : Triangle{0, 1, 2}));
    EXPECT_EQ(mb.faces[0], (mirror ? Triangle{1, 0, 2} : Triangle{0, 1, 2}));
    EXPECT_EQ(ma.vertex_normal, mb.vertex_normal);
  }
}

}  // namespace
}  // namespace parts::host
