// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/mlp_project.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <climits>
#include <filesystem>
#include <fstream>

#include "parts/base/error.h"
#include "support/folder.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

class MlpProjectFile : public test::Folder {
 protected:
  void TearDown() override {
    for (const char* name : {"p.mlp", "q.mlp"})
      if (fs::exists(at(name))) test::keep_for_corpus("mlp", test::contents(at(name)));
  }
  io::MlpProject read(const std::string& text) const {
    std::ofstream(at("p.mlp"), std::ios::binary) << text;
    test::keep_for_corpus("mlp", text);
    return io::read_mlp(at("p.mlp"));
  }
  std::string sentence(const std::string& text) const {
    try {
      read(text);
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  }
};

// As MeshLab 2020.09 writes it.
const char kMeshLabs[] = R"(<!DOCTYPE MeshLabDocument>
<MeshLabProject>
 <MeshGroup>
  <MLMesh label="a &amp; b" visible="1" filename="models/a &lt;1&gt;.ply">
   <MLMatrix44>
1 0 0 5 
0 0 -1 6 
0 1 0 7 
0 0 0 1 
</MLMatrix44>
   <RenderingOption pointSize="3" boxColor="234 234 234 255">100001000000000000000100000001010100000010100000000100111011110000001001</RenderingOption>
  </MLMesh>
  <MLMesh label="c" filename="c.obj"><MLMatrix44/></MLMesh>
 </MeshGroup>
 <RasterGroup>
  <MLRaster label="view 1">
   <VCGCamera TranslationVector="-1 -2 -3 1" RotationMatrix="0 1 0 0 -1 0 0 0 0 0 1 0 0 0 0 1 " CameraType="1" BinaryData="0" FocalMm="50" LensDistortion="0 0" PixelSizeMm="0.5 0.25" ViewportPx="640 480" CenterPx="320 240"/>
   <Plane fileName="v1.png" semantic="1"/>
   <Plane fileName="v1.tif" semantic="8"/>
  </MLRaster>
 </RasterGroup>
</MeshLabProject>
)";

TEST_F(MlpProjectFile, ReadsWhatMeshLabWrites) {
  const io::MlpProject p = read(kMeshLabs);
  ASSERT_EQ(p.meshes.size(), 2u);
  EXPECT_EQ(p.meshes[0].label, "a & b");
  EXPECT_EQ(p.meshes[0].file, at("models/a <1>.ply"));
  EXPECT_EQ((p.meshes[0].matrix * Eigen::Vector4d(1, 2, 3, 1)).head<3>(), Vec3(6, 3, 9));
  EXPECT_TRUE(p.meshes[1].matrix.isIdentity());
  ASSERT_EQ(p.rasters.size(), 1u);
  const io::MlpRaster& r = p.rasters[0];
  EXPECT_EQ(r.label, "view 1");
  EXPECT_TRUE(r.camera.given);
  EXPECT_EQ(r.camera.translation, Vec3(-1, -2, -3));
  EXPECT_EQ(r.camera.rotation * Vec3(1, 0, 0), Vec3(0, -1, 0));
  EXPECT_EQ(r.camera.viewport_px, Eigen::Vector2i(640, 480));
  EXPECT_EQ(r.camera.pixel_mm, Eigen::Vector2d(0.5, 0.25));
  EXPECT_EQ(r.camera.type, 1);
  EXPECT_EQ(r.planes.size(), 2u);
  EXPECT_EQ(r.file_of(io::plane::kDepth), at("v1.tif"));
  EXPECT_EQ(r.file_of(io::plane::kMask), "");
}

TEST_F(MlpProjectFile, ReadsBackWhatItWrites) {
  io::MlpProject p = read(kMeshLabs);
  p.meshes[0].matrix(0, 3) = 1.0 / 3;
  p.meshes[1].label = "\"quoted\" <&>";
  p.meshes[1].file = fs::absolute(at("sub/ä.ply")).string();
  io::write_mlp(p, at("q.mlp"));
  const io::MlpProject q = io::read_mlp(at("q.mlp"));
  ASSERT_EQ(q.meshes.size(), 2u);
  EXPECT_EQ(q.meshes[0].matrix, p.meshes[0].matrix);
  EXPECT_EQ(q.meshes[1].label, p.meshes[1].label);
  EXPECT_EQ(q.meshes[1].file, p.meshes[1].file);
  ASSERT_EQ(q.rasters.size(), 1u);
  EXPECT_EQ(q.rasters[0].camera.rotation, p.rasters[0].camera.rotation);
  EXPECT_EQ(q.rasters[0].camera.translation, p.rasters[0].camera.translation);
  EXPECT_EQ(q.rasters[0].camera.focal_mm, 50);
  EXPECT_EQ(q.rasters[0].planes[1].file, p.rasters[0].planes[1].file);
  for (const auto& entry : fs::directory_iterator(folder)) EXPECT_FALSE(is_draft_name(entry.path().filename()));
}

TEST_F(MlpProjectFile, NamesFilesRelativeToItsFolder) {
  io::MlpProject p;
  p.meshes.push_back({"m", at("models/m.ply")});
  io::write_mlp(p, at("p.mlp"));
  std::ifstream file(at("p.mlp"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(text.find("filename=\"models/m.ply\""), std::string::npos) << text;
}

TEST_F(MlpProjectFile, SaysWhatIsWrong) {
  EXPECT_NE(sentence("").find("is damaged"), std::string::npos);
  EXPECT_NE(sentence("ply\nformat ascii 1.0\n").find("is damaged"), std::string::npos);
  EXPECT_NE(sentence("<html/>").find("not a MeshLab project"), std::string::npos);
  EXPECT_NE(sentence("<MeshLabProject><MeshGroup>").find("is damaged"), std::string::npos);
  const std::string head = "<MeshLabProject><MeshGroup><MLMesh filename='a.ply'><MLMatrix44>",
                    tail = "</MLMatrix44></MLMesh></MeshGroup></MeshLabProject>";
  EXPECT_NE(sentence(head + "1 0 0" + tail).find("3 numbers"), std::string::npos);
  EXPECT_NE(sentence(head + "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 nan" + tail), "");
  EXPECT_NE(sentence(head + "AAAAAA==" + tail), "");
  EXPECT_THROW(io::read_mlp(at("missing.mlp")), UserError);
  EXPECT_THROW(io::read_mlp(folder.string()), UserError);
  EXPECT_THROW(io::write_mlp({}, at("no/such/folder/p.mlp")), UserError);
}

// Entities that expand to gigabytes must end as an error, soon.
TEST_F(MlpProjectFile, IsNotBlownUpByEntities) {
  std::string text = "<!DOCTYPE x [<!ENTITY a0 \"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\">";
  for (int i = 1; i < 12; ++i) {
    text += "<!ENTITY a" + std::to_string(i) + " \"";
    for (int k = 0; k < 10; ++k) text += "&a" + std::to_string(i - 1) + ";";
    text += "\">";
  }
  text +=
      "]><MeshLabProject><MeshGroup><MLMesh filename='a'><MLMatrix44>&a11;</MLMatrix44></MLMesh></MeshGroup>"
      "</MeshLabProject>";
  EXPECT_NE(sentence(text).find("is damaged"), std::string::npos);
}

TEST_F(MlpProjectFile, NumbersThatNoIntegerHolds) {
  const std::string head = "<MeshLabProject><RasterGroup><MLRaster label='r'>",
                    tail = "</MLRaster></RasterGroup></MeshLabProject>";
  std::ofstream(at("p.mlp")) << head +
                                    "<VCGCamera ViewportPx='1e300 -1e300' CameraType='1e99'/>"
                                    "<Plane semantic='1e300' fileName='x'/><Plane semantic='-1e300' fileName='y'/>" +
                                    tail;
  const io::MlpProject p = io::read_mlp(at("p.mlp"));
  ASSERT_EQ(p.rasters.size(), 1u);
  EXPECT_EQ(p.rasters[0].planes[0].semantic, INT_MAX);
  EXPECT_EQ(p.rasters[0].planes[1].semantic, INT_MIN);
  EXPECT_EQ(p.rasters[0].camera.viewport_px, Eigen::Vector2i(INT_MAX, 0));
}

TEST_F(MlpProjectFile, DeepNestingAndStrangeNamesComeBack) {
  std::string deep = "<MeshLabProject>";
  for (int i = 0; i < 200000; ++i) deep += "<a>";
  EXPECT_NE(sentence(deep).find("is damaged"), std::string::npos);
  io::MlpProject p;
  p.meshes.push_back({"<a> & \"b\" 'c' \t K\xc3\xb6pfe", at("x & y\".ply")});
  io::write_mlp(p, at("q.mlp"));
  const io::MlpProject q = io::read_mlp(at("q.mlp"));
  ASSERT_EQ(q.meshes.size(), 1u);
  EXPECT_EQ(q.meshes[0].label, p.meshes[0].label);
  EXPECT_EQ(q.meshes[0].file, p.meshes[0].file);
}

}  // namespace
}  // namespace parts
