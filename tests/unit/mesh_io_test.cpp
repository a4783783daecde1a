// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/mesh_io.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "parts/base/error.h"
#include "parts/mesh/arrays.h"
#include "parts/mesh/topology.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

class MeshIo : public test::Folder {
 protected:
  void TearDown() override {
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (const std::string ending = lower_extension(entry.path()); entry.is_regular_file() && !ending.empty())
        if (entry.file_size() < 65536) test::keep_for_corpus(ending.substr(1), test::contents(entry.path()));
  }
  std::string file(const std::string& name, const std::string& bytes) const {
    std::ofstream(at(name), std::ios::binary) << bytes;
    if (const std::string ending = lower_extension(name); !ending.empty())
      test::keep_for_corpus(ending.substr(1), bytes);
    return at(name);
  }
  Mesh read(const std::string& name, const std::string& bytes) const { return io::read_mesh(file(name, bytes)); }
  /// The sentence that reading ends with; "" if it does not fail.
  std::string sentence(const std::string& name, const std::string& bytes) const {
    try {
      read(name, bytes);
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  }
};

Mesh with_everything() {
  Mesh mesh = test::sphere({1e6 + 0.1, -3, 1e-3}, 0.3, 2);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    mesh.vertex_normal.push_back((mesh.vertices[v] - Vec3(1e6, -3, 0)).normalized().cast<float>());
    mesh.vertex_color.push_back({std::uint8_t(v), std::uint8_t(2 * v), 7, 255});
    mesh.vertex_quality.push_back(float(v) / 3);
    mesh.vertex_selected.push_back(v % 3 == 0);
  }
  mesh.textures = {"a b.png", "c.jpg"};
  for (int f = 0; f < mesh.face_count(); ++f) {
    mesh.face_color.push_back({std::uint8_t(f % 7), 2, std::uint8_t(f % 5), 255});
    mesh.face_quality.push_back(float(f) * 0.1f);
    mesh.face_selected.push_back(f % 2);
    Wedges w;
    for (int k = 0; k < 3; ++k) w.uv[k] = {float(f) / 700, float(k) / 3};
    w.texture = f % 3 - 1;
    mesh.wedges.push_back(w);
  }
  return mesh;
}

void expect_same_wedges(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.wedges.size(), b.wedges.size());
  for (std::size_t f = 0; f < a.wedges.size(); ++f) {
    EXPECT_EQ(a.wedges[f].texture, b.wedges[f].texture);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(a.wedges[f].uv[k], b.wedges[f].uv[k]);
  }
}

TEST_F(MeshIo, PlyKeepsEverything) {
  const Mesh mesh = with_everything();
  io::write_mesh(mesh, at("m.ply"));
  const Mesh back = io::read_mesh(at("m.ply"));
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.faces, mesh.faces);
  EXPECT_EQ(back.vertex_normal, mesh.vertex_normal);
  EXPECT_EQ(back.vertex_color, mesh.vertex_color);
  EXPECT_EQ(back.vertex_quality, mesh.vertex_quality);
  EXPECT_EQ(back.vertex_selected, mesh.vertex_selected);
  EXPECT_EQ(back.face_color, mesh.face_color);
  EXPECT_EQ(back.face_quality, mesh.face_quality);
  EXPECT_EQ(back.face_selected, mesh.face_selected);
  expect_same_wedges(back, mesh);
  EXPECT_EQ(back.textures, (std::vector<std::string>{at("a b.png"), at("c.jpg")}));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1) << "no drafts are left";
}

TEST_F(MeshIo, PlyOfFloatsIsSmaller) {
  io::write_mesh(test::box({0, 0, 0}, {1, 1, 1}), at("floats.ply"));
  io::write_mesh(test::box({0, 0, 0}, {0.1, 0.1, 0.1}), at("doubles.ply"));
  EXPECT_LT(fs::file_size(at("floats.ply")), fs::file_size(at("doubles.ply")));
}

TEST_F(MeshIo, ObjKeepsWhatItHolds) {
  const Mesh mesh = with_everything();
  io::write_mesh(mesh, at("m.obj"));
  const Mesh back = io::read_mesh(at("m.obj"));
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.faces, mesh.faces);
  EXPECT_EQ(back.vertex_color, mesh.vertex_color);
  ASSERT_EQ(back.vertex_normal.size(), mesh.vertex_normal.size());
  for (std::size_t v = 0; v < back.vertex_normal.size(); ++v)
    EXPECT_LT((back.vertex_normal[v] - mesh.vertex_normal[v]).norm(), 1e-5);
  ASSERT_EQ(back.face_color.size(), mesh.face_color.size());
  for (std::size_t f = 0; f < back.wedges.size(); ++f) {
    EXPECT_EQ(back.wedges[f].uv[1], mesh.wedges[f].uv[1]);
    const int t = back.wedges[f].texture, u = mesh.wedges[f].texture;
    ASSERT_EQ(t < 0, u < 0);
    if (t >= 0) {
      EXPECT_EQ(back.textures[t], at(mesh.textures[u]));
    } else {
      EXPECT_EQ(back.face_color[f], mesh.face_color[f]);
    }
  }
}

TEST_F(MeshIo, OffKeepsWhatItHolds) {
  const Mesh mesh = with_everything();
  io::write_mesh(mesh, at("m.off"));
  const Mesh back = io::read_mesh(at("m.off"));
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.faces, mesh.faces);
  EXPECT_EQ(back.vertex_color, mesh.vertex_color);
  EXPECT_EQ(back.vertex_normal, mesh.vertex_normal);
  EXPECT_EQ(back.face_color, mesh.face_color);
}

TEST_F(MeshIo, TinyCoordinatesSurviveText) {
  const Mesh mesh = test::sphere({0, 0, 0}, 1e-6, 1);
  for (const char* name : {"m.obj", "m.off"}) {
    io::write_mesh(mesh, at(name));
    EXPECT_EQ(io::read_mesh(at(name)).vertices, mesh.vertices);
  }
}

TEST_F(MeshIo, TexturesAreNamedFromTheFileThatNamesThem) {
  fs::create_directories(at("images"));
  file("images/skin.png", "not read here");
  Mesh mesh = with_everything();
  mesh.textures = {at("images/skin.png"), "missing.png"};
  for (const char* name : {"m.ply", "m.obj"}) {
    io::write_mesh(mesh, at(name));
    const Mesh back = io::read_mesh(at(name));
    ASSERT_EQ(back.textures.size(), 2u);
    const bool skin_first = back.textures[0].find("skin") != std::string::npos;
    EXPECT_EQ(back.textures[skin_first ? 0 : 1], at("images/skin.png"));
    std::ifstream written(at(name), std::ios::binary);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(written), {}).find(folder.string()), std::string::npos);
  }
}

TEST_F(MeshIo, BackslashesAndForeignFolders) {
  file("skin.png", "");
  file("m.mtl", "newmtl a\nmap_Kd C:\\models\\skin.png\nnewmtl b\nmap_Kd -s 1 1 1 skin.png\r\n");
  const Mesh mesh = read("m.obj",
                         "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                         "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 2/2\n");
  EXPECT_EQ(mesh.textures[0], at("skin.png"));
  EXPECT_EQ(mesh.textures[1], at("skin.png"));
  EXPECT_EQ(mesh.wedges[1].texture, 1);
}

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST_F(MeshIo, ObjDialects) {
  const std::string t = kTriangle;
  EXPECT_EQ(read("crlf.obj", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n").face_count(), 1);
  EXPECT_EQ(read("negative.obj", t + "f -3 -2 -1\n").faces[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(read("forward.obj", "f 1 2 3\n" + t).face_count(), 1);
  EXPECT_EQ(read("indented.obj", "  v 0 0 0\n\tv 1 0 0\n v 0 1 0\n  f 1 2 3\n").face_count(), 1);
  EXPECT_EQ(read("continued.obj", t + "f 1 \\\n2 \\\r\n3\n").face_count(), 1);
  EXPECT_EQ(read("unended.obj", t + "f 1 2 3").face_count(), 1);
  EXPECT_EQ(read("nomtl.obj", "mtllib gone.mtl\nusemtl skin\n" + t + "f 1 2 3\n").textures.size(), 0u);
  EXPECT_EQ(read("normals.obj", t + "vn 0 0 2\nf 1//1 2//1 3//1\n").vertex_normal[2], Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(read("weights.obj", "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n").vertex_color.size(), 0u);
  const Mesh mixed = read("mixed.obj", t + "vt 0.5 0.25\nf 1/1 2/1 3/1\nf 3 2 1\nl 1 2\np 1\n");
  EXPECT_EQ(mixed.face_count(), 2);
  EXPECT_EQ(mixed.wedges[0].uv[2], Eigen::Vector2f(0.5f, 0.25f));
  EXPECT_EQ(mixed.wedges[1].texture, -1);
  const Mesh colored = read("colored.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 0 0 1\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(colored.vertex_color[0], (Color{255, 128, 0, 255}));
  EXPECT_EQ(colored.vertex_color[2], (Color{255, 255, 255, 255}));
}

TEST_F(MeshIo, ObjSeamsShareTheirVertices) {
  const Mesh mesh = read("seam.obj",
                         "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 0.5 0\nvt 1 1\nvt 0.9 0.1\n"
                         "f 1/1 2/2 3/3\nf 2/4 4/3 3/1\n");
  EXPECT_EQ(mesh.vertex_count(), 4);
  EXPECT_EQ(mesh::edge_map(mesh).boundary_edges, 4);
  EXPECT_EQ(mesh.wedges[0].uv[1], Eigen::Vector2f(0.5f, 0));
  EXPECT_EQ(mesh.wedges[1].uv[0], Eigen::Vector2f(0.9f, 0.1f));
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    sum += (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0)).z() / 2;
  return sum;
}

TEST_F(MeshIo, PolygonsAreTriangulated) {
  // A concave quad, an L, and a spiral: area and no flipped triangle.
  const char* polygons[] = {"v 0 0 0\nv 2 2 0\nv 0 1 0\nv -2 2 0\nf 1 2 3 4\n",
                            "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6\n",
                            "v 0 0 0\nv 5 0 0\nv 5 5 0\nv 1 5 0\nv 1 2 0\nv 3 2 0\nv 3 3 0\nv 2 3 0\nv 2 4 0\nv 4 4 0\n"
                            "v 4 1 0\nv 0 1 0\nf 1 2 3 4 5 6 7 8 9 10 11 12\n"};
  const double areas[] = {2, 5, 15};
  for (int i = 0; i < 3; ++i) {
    const Mesh mesh = read("p.obj", polygons[i]);
    EXPECT_EQ(mesh.face_count(), mesh.vertex_count() - 2);
    EXPECT_NEAR(area(mesh), areas[i], 1e-12);
    for (int f = 0; f < mesh.face_count(); ++f) {
      Mesh one = mesh;
      one.faces = {mesh.faces[f]};
      EXPECT_GT(area(one), 0) << "polygon " << i << " face " << f;
    }
  }
  EXPECT_EQ(read("quad.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n").face_count(), 2);
  EXPECT_EQ(read("flat.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n4 0 1 2 3\n").face_count(), 2);
}

TEST_F(MeshIo, OffDialects) {
  const std::string v = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(read("oneline.off", "OFF 3 1 0\n" + v + "3 0 1 2\n").face_count(), 1);
  EXPECT_EQ(read("comments.off", "OFF # x\n\n# y\n3 1\r\n" + v + "# z\n3 0 1 2 # w").face_count(), 1);
  EXPECT_EQ(read("packed.off", "OFF\n3 1 0\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n").vertices[2], Vec3(0, 1, 0));
  EXPECT_EQ(read("map.off", "OFF\n3 1 0\n" + v + "3 0 1 2 900\n").face_color.size(), 0u);
  EXPECT_EQ(read("shares.off", "OFF\n3 1 0\n" + v + "3 0 1 2 1.0 0.5 0\n").face_color[0], (Color{255, 128, 0, 255}));
  const Mesh some = read("some.off", "OFF\n3 3 0\n" + v + "3 0 1 2\n3 0 1 2 9 8 7 6\n3 0 1 2\n");
  EXPECT_EQ(some.face_color, (std::vector<Color>{{255, 255, 255, 255}, {9, 8, 7, 6}, {255, 255, 255, 255}}));
  const Mesh full = read("full.off",
                         "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 8 7 255 .5 .5\n1 0 0 0 0 1 9 8 7 255 1 .5\n"
                         "0 1 0 0 0 1 9 8 7 255 .5 1\n3 0 1 2\n");
  EXPECT_EQ(full.vertex_color[1], (Color{9, 8, 7, 255}));
  EXPECT_EQ(full.wedges[0].uv[1], Eigen::Vector2f(1, .5f));
  EXPECT_EQ(read("four.off", "4OFF\n3 1 0\n0 0 0 2\n2 0 0 2\n0 2 0 2\n3 0 1 2\n").vertices[1], Vec3(1, 0, 0));
}

std::string ply(const std::string& format, const std::string& vertex, const std::string& face, const std::string& body,
                int vertices = 3, int faces = 1) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(vertices) + "\n" + vertex +
         "element face " + std::to_string(faces) + "\n" + face + "end_header\n" + body;
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kIndices = "property list uchar int vertex_indices\n";
const std::string kBody = "0 0 0\n1 0 0\n0 1 0\n";

TEST_F(MeshIo, PlyDialects) {
  EXPECT_EQ(read("a.ply", ply("ascii", kXyz, kIndices, kBody + "3 0 1 2")).face_count(), 1);
  std::string crlf = ply("ascii", kXyz, kIndices, kBody + "3 0 1 2\n");
  for (std::size_t i = 0; (i = crlf.find('\n', i)) != crlf.npos; i += 2) crlf.insert(i, "\r");
  EXPECT_EQ(read("crlf.ply", crlf).face_count(), 1);
  const std::string ints = "property int x\nproperty short y\nproperty double z\n";
  EXPECT_EQ(
      read("int.ply", ply("ascii", ints, "property list int uint vertex_index\n", kBody + "3 0 1 2")).face_count(), 1);
  const Mesh uv = read("uv.ply", ply("ascii", kXyz + "property float s\nproperty float t\n", kIndices,
                                     "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 .5\n3 0 1 2"));
  EXPECT_EQ(uv.wedges[0].uv[2], Eigen::Vector2f(0, .5f));
  const Mesh quad =
      read("quad.ply", ply("ascii", kXyz, kIndices + "property list uchar float texcoord\nproperty uchar red\n",
                           "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 8 0 0 1 0 1 1 0 1 9\n", 4));
  ASSERT_EQ(quad.face_count(), 2);
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(quad.wedges[f].uv[k], quad.corner(f, k).head<2>().cast<float>());
  EXPECT_EQ(quad.face_color[1][0], 9);
  const Mesh strip = read("strip.ply", "ply\nformat ascii 1.0\nelement vertex 4\n" + kXyz +
                                           "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                                           "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 2\n");
  EXPECT_EQ(strip.faces, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {0, 1, 2}}));
  EXPECT_EQ(read("nan.ply", ply("ascii", kXyz, kIndices, "nan 0 0\n1 -inf 0\n0 1 -nan(ind)\n3 0 1 2")).face_count(), 1);
}

TEST_F(MeshIo, PlyBigEndian) {
  std::string body;
  for (float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f}) {
    char raw[4];
    std::memcpy(raw, &x, 4);
    body += std::string{raw[3], raw[2], raw[1], raw[0]};
  }
  body += std::string("\3\0\0\0\0\0\0\0\1\0\0\0\2", 13);
  const Mesh mesh = read("big.ply", ply("binary_big_endian", kXyz, kIndices, body));
  EXPECT_EQ(mesh.vertices[2], Vec3(0, 2, 0));
  EXPECT_EQ(mesh.faces[0], (Triangle{0, 1, 2}));
}

template <class T>
std::string raw(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

std::string stl(const std::vector<float>& corners, std::uint32_t count, std::uint16_t color = 0) {
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");
  bytes += raw<std::uint32_t>({count});
  for (std::size_t i = 0; i + 8 < corners.size(); i += 9)
    bytes += std::string(12, '\0') + raw(std::vector<float>(corners.begin() + long(i), corners.begin() + long(i) + 9)) +
             raw<std::uint16_t>({color});
  return bytes;
}

TEST_F(MeshIo, StlCornersAreWelded) {
  const std::vector<float> corners{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, -0.f, 1, 0};
  const Mesh mesh = read("b.stl", stl(corners, 2, 0x8000 | 31 << 10));
  EXPECT_EQ(mesh.vertex_count(), 4);
  EXPECT_EQ(mesh::edge_map(mesh).boundary_edges, 4);
  EXPECT_EQ(mesh.face_color[0], (Color{255, 0, 0, 255}));
  const Mesh text =
      read("t.stl",
           "solid vertex of evil\r\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
           "endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n"
           "endloop\nendfacet\nendsolid\n");
  EXPECT_EQ(text.vertex_count(), 4);
  EXPECT_EQ(text.face_count(), 2);
}

TEST_F(MeshIo, StlDialects) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1.0E+000 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  std::string upper = "solid x\n" + facet + "endsolid x\n";
  for (char& c : upper) c = char(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(read("upper.stl", upper).face_count(), 1);
  EXPECT_EQ(read("blank.stl", "\xEF\xBB\xBF  solid x\r\n" + facet + "endsolid\r\n").face_count(), 1);
  EXPECT_EQ(read("two.stl", "solid a\n" + facet + "endsolid a\nsolid b\n" + facet + "endsolid b\n").face_count(), 2);
  const std::vector<float> corners{0, 0, 0, 1, 0, 0, 0, 1, 0};
  EXPECT_EQ(read("padded.stl", stl(corners, 1) + std::string(2, '\0')).face_count(), 1);
  std::string old_mac = "solid x\n" + facet + "endsolid x\n";
  std::replace(old_mac.begin(), old_mac.end(), '\n', '\r');
  EXPECT_EQ(read("mac.stl", old_mac).face_count(), 1);
}

TEST_F(MeshIo, SeveralListsOfFacesHaveWholeAttributes) {
  const std::string head = "ply\nformat ascii 1.0\ncomment TextureFile t.png\nelement vertex 3\n" + kXyz,
                    plain = "element face 2\n" + kIndices,
                    dressed = "element face 1\n" + kIndices +
                              "property list uchar float texcoord\nproperty uchar red\nproperty float quality\n"
                              "property int flags\n",
                    two = "3 0 1 2\n3 2 1 0\n", one = "3 0 1 2 6 0 0 1 0 0 1 77 0.5 32\n", end = "end_header\n" + kBody;
  for (const bool plain_first : {true, false}) {
    const Mesh m =
        read("two.ply", head + (plain_first ? plain + dressed + end + two + one : dressed + plain + end + one + two));
    ASSERT_EQ(m.face_count(), 3);
    ASSERT_EQ(m.face_color.size(), 3u);
    ASSERT_EQ(m.face_quality.size(), 3u);
    ASSERT_EQ(m.face_selected.size(), 3u);
    ASSERT_EQ(m.wedges.size(), 3u);
    const int with = plain_first ? 2 : 0, without = plain_first ? 0 : 2;
    EXPECT_EQ(m.face_color[with][0], 77);
    EXPECT_EQ(m.face_color[without], (Color{255, 255, 255, 255}));
    EXPECT_EQ(m.wedges[with].texture, 0);
    EXPECT_EQ(m.wedges[without].texture, -1);
    EXPECT_EQ(m.face_selected[with], 1);
    EXPECT_EQ(m.face_quality[without], 0);
  }
}

TEST(Arrays, FlawsAreSeen) {
  const auto flawed = [](const auto& change) {
    Mesh m = with_everything();
    EXPECT_EQ(mesh::array_flaw(m), "");
    change(m);
    return !mesh::array_flaw(m).empty();
  };
  EXPECT_EQ(mesh::array_flaw({}), "");
  EXPECT_TRUE(flawed([](Mesh& m) { m.faces[3][1] = m.vertex_count(); }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.faces[3][1] = -1; }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.face_color.pop_back(); }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.face_quality.pop_back(); }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.face_selected.pop_back(); }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.wedges.pop_back(); }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.wedges[0].texture = 2; }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.wedges[0].texture = -2; }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.vertex_color.pop_back(); }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.vertex_normal.pop_back(); }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.vertex_quality.pop_back(); }));
  EXPECT_TRUE(flawed([](Mesh& m) { m.vertex_selected.pop_back(); }));
}

TEST_F(MeshIo, AFlawedMeshIsNotWritten) {
  Mesh mesh = with_everything();
  mesh.face_color.pop_back();
  EXPECT_THROW(io::write_mesh(mesh, at("m.ply")), std::logic_error);
  EXPECT_FALSE(fs::exists(at("m.ply")));
}

TEST_F(MeshIo, MaterialsOfTheField) {
  const std::string obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
  file("skin one.png", "");
  fs::create_directories(at("tex"));
  file("tex/Inner.JPG", "");
  const std::string latin = "K\xf6pfe.png", utf8 = "K\xc3\xb6pfe.png";
  file(utf8, "");
  const std::pair<std::string, std::string> lines[] = {
      {"map_kd skin one.png", "skin one.png"},
      {"MAP_KD skin one.png ", "skin one.png"},
      {"map_Kd -s 1 1 1 skin one.png", "skin one.png"},
      {"map_Kd -blendu on -o 0.5 0 -mm 0 1 -clamp on -bm 1 skin one.png", "skin one.png"},
      {"map_Kd \"skin one.png\"", "skin one.png"},
      {"map_Kd -s 1 1 \"skin one.png\"", "skin one.png"},
      {"map_Kd C:\\Users\\u\\tex\\inner.jpg", "tex/Inner.JPG"},
      {"map_Kd tex\\Inner.JPG", "tex/Inner.JPG"},
      {"map_Kd /home/u/scans/SKIN ONE.PNG", "skin one.png"},
      {"map_Kd " + latin, utf8},
  };
  for (const auto& [line, found] : lines) {
    file("m.mtl", "\xEF\xBB\xBF# x\r\nnewmtl a\r\n" + line + "\r\n");
    std::vector<std::string> missing;
    const Mesh mesh = io::read_mesh(file("m.obj", obj), {}, &missing);
    ASSERT_EQ(mesh.textures.size(), 1u) << line;
    EXPECT_EQ(mesh.textures[0], at(found)) << line;
    EXPECT_TRUE(missing.empty()) << line;
    EXPECT_EQ(mesh.wedges[0].texture, 0);
  }
  file("m.mtl", "newmtl a\nmap_Kd lost.png\n");
  std::vector<std::string> missing;
  io::read_mesh(file("m.obj", obj), {}, &missing);
  EXPECT_EQ(missing, (std::vector<std::string>{"lost.png"}));
  fs::remove(at("m.mtl"));
  io::read_mesh(at("m.obj"), {}, &missing);
  EXPECT_EQ(missing, (std::vector<std::string>{"m.mtl"}));
}

TEST_F(MeshIo, PolygonsOfManyCornersAreQuick) {
  // A spiral, of which most corners that stick out are no ears: 100 times 1000 corners.
  std::string off = "OFF\n1000 100 0\n", face = "1000";
  for (int i = 0; i < 1000; ++i) {
    const int k = i < 500 ? i : 999 - i;
    const double a = k * 0.15, r = 1 + a + (i < 500 ? 0 : 2.9);
    off += std::to_string(r * std::cos(a)) + " " + std::to_string(r * std::sin(a)) + " 0\n";
    face += " " + std::to_string(i);
  }
  for (int f = 0; f < 100; ++f) off += face + "\n";
  const std::clock_t start = std::clock();
  EXPECT_EQ(read("spiral.off", off).face_count(), 100 * 998);
  EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, 20) << "minutes, if each cut looks at all corners again";
}

TEST_F(MeshIo, ReadingCanBeCancelledAndIsNotBlind) {
  io::write_mesh(test::sphere({0, 0, 0}, 1, 6), at("m.ply"));
  io::write_mesh(test::sphere({0, 0, 0}, 1, 6), at("m.obj"));
  io::write_mesh(test::sphere({0, 0, 0}, 1, 6), at("m.off"));
  for (const char* name : {"m.ply", "m.obj", "m.off"}) {
    int polls = 0;
    EXPECT_THROW(io::read_mesh(at(name),
                               [&] {
                                 if (++polls == 4) throw Cancelled();
                               }),
                 Cancelled)
        << name;
  }
  for (const char* name : {"s.ply", "s.obj", "s.off", "s.stl"}) {  // nothing but zeros, and more than there is memory
    fs::resize_file(file(name, ""), std::uintmax_t(1) << 42);
    const std::string s = [&] {
      try {
        io::read_mesh(at(name));
      } catch (const UserError& e) {
        return std::string(e.what());
      }
      return std::string();
    }();
    EXPECT_NE(s.find("; export the mesh again."), s.npos) << name << s;
  }
}

TEST_F(MeshIo, BrokenFilesGiveOneSentence) {
  const std::string t = kTriangle, v = "0 0 0\n1 0 0\n0 1 0\n", binary = "binary_little_endian";
  const std::string three = raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}), index = raw<std::int32_t>({0, 1, 2});
  const std::pair<const char*, std::string> files[] = {
      {"empty.ply", ""},
      {"empty.obj", ""},
      {"empty.off", ""},
      {"empty.stl", ""},
      {"blank.off", "\n\n\n"},
      {"word.off", "OFX\n3 1 0\n"},
      {"index.off", "OFF\n3 1 0\n" + v + "3 0 1 999999999\n"},
      {"negative.off", "OFF\n3 1 0\n" + v + "3 0 1 -1\n"},
      {"huge.off", "OFF\n2000000000 1 0\n0 0 0\n"},
      {"huge2.off", "OFF\n9000000000000000000 1 0\n0 0 0\n"},
      {"counts.off", "OFF\n-3 1 0\n" + v},
      {"cut.off", "OFF\n3 2 0\n" + v + "3 0 1 2\n"},
      {"polygon.off", "OFF\n3 1 0\n" + v + "2000000000 0 1 2\n"},
      {"letters.off", "OFF\n3 1 0\n0 zero 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"points.off", "OFF\n3 0 0\n" + v},
      {"half.off", "OFF\n3 1 0\n" + v + "3 0 1 1.5\n"},
      {"index.obj", t + "f 1 2 4\n"},
      {"zero.obj", t + "f 0 1 2\n"},
      {"far.obj", t + "f -4 1 2\n"},
      {"uv.obj", t + "f 1/1 2/2 3/3\n"},
      {"normal.obj", t + "f 1//7 2//7 3//7\n"},
      {"short.obj", "v 0 0\n"},
      {"points.obj", t},
      {"slashes.obj", t + "f / / /\n"},
      {"wide.obj", t + "f 99999999999999999999 1 2\n"},
      {"header.ply", "ply\nformat ascii 1.0\n"},
      {"noply.ply", "plyx\n"},
      {"format.ply", "ply\nformat ebcdic 1.0\nend_header\n"},
      {"type.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty string x\nend_header\n0\n"},
      {"orphan.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n0\n"},
      {"huge.ply", ply("ascii", kXyz, kIndices, v, 2000000000)},
      {"hugefaces.ply", ply(binary, kXyz, kIndices, three, 3, 2000000000)},
      {"hugelist.ply", ply(binary, kXyz, "property list int int vertex_indices\n",
                           three + raw<std::int32_t>({2000000000}) + std::string(80, '\0'))},
      {"negativelist.ply", ply(binary, kXyz, "property list int int vertex_indices\n",
                               three + raw<std::int32_t>({-5}) + std::string(80, '\0'))},
      {"index.ply", ply("ascii", kXyz, kIndices, v + "3 0 1 3")},
      {"nanindex.ply", ply("ascii", kXyz, "property list uchar float vertex_indices\n", v + "3 0 1 nan")},
      {"cut.ply", ply(binary, kXyz, kIndices, three + "\3" + index.substr(0, 11))},
      {"noxyz.ply", ply("ascii", "property float x\n", kIndices, "0 0 0 3 0 1 2")},
      {"points.ply", ply("ascii", kXyz, kIndices, v, 3, 0)},
      {"twice.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\n" + kXyz + "element vertex 1\n" + kXyz + "end_header\n0 0 0 0 0 0"},
      {"cut.stl", stl({0, 0, 0, 1, 0, 0, 0, 1, 0}, 100)},
      {"huge.stl", std::string(80, '\0') + std::string(54, '\xff')},
      {"short.stl", "solid"},
      {"tiny.stl", "x"},
      {"none.stl", stl({}, 0)},
      {"corners.stl", "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nendloop\n"},
      {"cuttext.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0"},
      {"model.fbx", "x"},
  };
  for (const auto& [name, bytes] : files) {
    const std::string s = sentence(name, bytes);
    EXPECT_NE(s.find(name), s.npos) << name << ": " << s;
    EXPECT_NE(s.find("; "), s.npos) << name << ": " << s;
    EXPECT_EQ(s.back(), '.') << s;
  }
}

TEST_F(MeshIo, EveryCutOfAFileIsASentenceOrAMesh) {
  Mesh mesh = with_everything();
  mesh.faces.resize(20);
  mesh.face_color.resize(20), mesh.face_quality.resize(20), mesh.face_selected.resize(20), mesh.wedges.resize(20);
  for (const char* name : {"m.ply", "m.obj", "m.off"}) {
    io::write_mesh(mesh, at(name));
    std::ifstream in(at(name), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    for (std::size_t n = 0; n < bytes.size(); n += 1 + bytes.size() / 150) {
      sentence(std::string("cut_") + name, bytes.substr(0, n));
      std::string bent = bytes;  // and with one byte wrong
      bent[n] = char(bent[n] ^ (1 << n % 8));
      sentence(std::string("bent_") + name, bent);
    }
  }
}

TEST_F(MeshIo, FilesThatCannotBeOpened) {
  EXPECT_THROW(io::read_mesh(at("missing.ply")), UserError);
  fs::create_directories(at("folder.ply"));
  EXPECT_THROW(io::read_mesh(at("folder.ply")), UserError);
  EXPECT_THROW(io::write_mesh(test::sphere(), at("folder.ply")), UserError);
  EXPECT_THROW(io::write_mesh(test::sphere(), at("no/such/folder/a.ply")), UserError);
  EXPECT_THROW(io::write_mesh(test::sphere(), at("a.stl")), UserError);
  if (fs::exists("/dev/full")) {
    fs::create_symlink("/dev/full", at("full.ply"));
    EXPECT_THROW(io::write_mesh(test::sphere(), at("full.ply")), UserError);
    EXPECT_TRUE(fs::is_symlink(at("full.ply")));
  }
}

}  // namespace
}  // namespace parts
