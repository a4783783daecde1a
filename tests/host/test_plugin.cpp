// SPDX-License-Identifier: GPL-3.0-or-later
// The plugin class over a table of test filters: parameters, failures, commits.
#include <gtest/gtest.h>

#include <QApplication>
#include <QDir>
#include <QFileInfo>
#include <QImage>

#include "host_harness.h"
#include "parts/base/error.h"
#include "support/shapes.h"

namespace parts::host {
namespace {

/// What the next run of the test filter does.
std::function<Outcome(const Inputs&, Progress&)> next;

std::vector<Parameter> parameters(const Scene& scene) {
  return {current_layer("A", "a", ""),
          other_layer("B", "b", ""),
          flag("Flag", true, "f", ""),
          integer("Integer", 3, 0, 10, "i", ""),
          number("Number", 0.5, 0, 1, "n", ""),
          length("Length", 0, "l", ""),
          choice("Choice", 1, {"x", "y"}, "c", ""),
          point("Point", scene.current.isEmpty() ? Vec3(1, 2, 3) : Vec3(scene.current.max()), "p", "")};
}

/// A document of two layers of a triangle each, and the filter's parameters.
struct HostPlugin : testing::Test {
  HostPlugin() {
    for (const char* name : {"one", "two"}) {
      MeshModel* layer = document.addNewMesh("", name);
      vcg::tri::Allocator<CMeshO>::AddVertices(layer->cm, 3);
      layer->cm.vert[1].P() = {3, 0, 0};
      layer->cm.vert[2].P() = {0, 4, 0};
      vcg::tri::Allocator<CMeshO>::AddFace(layer->cm, 0, 1, 2);
      api::update_box_and_normals(*layer);
    }
    document.setCurrentMesh(0);
    plugin.setLog(&log);
    list = test::defaults(plugin, document);
  }
  QAction* action() { return plugin.actions().front(); }
  std::string failure(vcg::CallBackPos* callback = nullptr) { return test::run(plugin, document, list, log, callback); }
  bool apply() { return failure().empty(); }
  int layer_count() const { return int(api::layers_of(document).size()); }
  MeshModel& layer(int i) { return *api::layers_of(document)[i]; }
  std::string last_line() {
    return log.logStringList().isEmpty() ? "" : log.logStringList().last().second.toStdString();
  }
  /// The run fails with this sentence, and nothing has changed.
  void expect_failure(const std::string& sentence, vcg::CallBackPos* callback = nullptr) {
    EXPECT_EQ(failure(callback), sentence);
    ASSERT_EQ(layer_count(), 2);
    EXPECT_EQ(document.mm()->id(), 0);
    for (MeshModel* layer : api::layers_of(document)) {
      EXPECT_TRUE(layer->isVisible());
      EXPECT_EQ(layer->cm.vert[1].P(), Point3m(3, 0, 0));
    }
  }

  MeshDocument document;
  GLLogStream log;
  Plugin plugin;
  RichParameterList list;
};

Mesh triangle() {
  Mesh m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  m.faces = {{0, 1, 2}};
  return m;
}

TEST_F(HostPlugin, DefaultsDependOnTheDocument) {
  next = [&](const Inputs& in, Progress&) {
    EXPECT_EQ(in.layer("A").name(), "one");
    EXPECT_EQ(in.layer("B").name(), "two");
    EXPECT_TRUE(in.flag("Flag"));
    EXPECT_EQ(in.integer("Integer"), 3);
    EXPECT_EQ(in.number("Number"), 0.5);
    EXPECT_EQ(in.length("Length"), 0);
    EXPECT_EQ(in.choice("Choice"), 1);
    EXPECT_EQ(in.point("Point"), Vec3(3, 4, 0));
    return Outcome();
  };
  EXPECT_TRUE(apply());
  EXPECT_EQ(dynamic_cast<const api::RichLength&>(list.getParameterByName("Length")).max, 5) << "the diagonal";
}

TEST_F(HostPlugin, ADocumentWithoutLayers) {
  MeshDocument empty;
  const RichParameterList of_empty = test::defaults(plugin, empty);
  EXPECT_EQ(of_empty.size(), list.size());
  EXPECT_EQ(dynamic_cast<const api::RichLength&>(of_empty.getParameterByName("Length")).max, 1);
  next = [](const Inputs& in, Progress&) {
    in.layer("A");
    return Outcome();
  };
  EXPECT_EQ(test::run(plugin, empty, of_empty, log, nullptr), "There is no layer for A; load a mesh and choose it.");
}

TEST_F(HostPlugin, LayersAreAddedAndInputsHidden) {
  next = [](const Inputs& in, Progress&) {
    Outcome out;
    out.layers = {{"Result", triangle()}, {"Extra", triangle(), false}};
    out.current = 0;
    out.hidden = {in.layer("A")};
    return out;
  };
  ASSERT_TRUE(apply());
  ASSERT_EQ(layer_count(), 4);
  EXPECT_EQ(document.mm()->label(), "Result");
  EXPECT_EQ(document.mm()->cm.fn, 1);
  EXPECT_FALSE(layer(0).isVisible());
  EXPECT_TRUE(layer(2).isVisible());
  EXPECT_FALSE(layer(3).isVisible());
}

TEST_F(HostPlugin, RasterLayers) {
  render::Camera camera;
  camera.width = 60, camera.height = 80, camera.center = {30, 40};
  next = [&](const Inputs& in, Progress&) {
    EXPECT_FALSE(in.raster()) << "there is none";
    Outcome out;
    out.layers = {{"Result", triangle(), true, camera}};
    out.rasters = {{"photo", "some/photo.png", camera, 5}};
    return out;
  };
  ASSERT_TRUE(apply());
  ASSERT_EQ(test::raster_count(document), 1);
  ASSERT_TRUE(document.rm());
  EXPECT_EQ(document.rm()->label(), "photo");
  EXPECT_TRUE(layer(2).hasDataMask(MeshModel::MM_CAMERA));
  EXPECT_TRUE(layer(2).cm.shot.IsValid());
  next = [](const Inputs& in, Progress&) {
    EXPECT_TRUE(in.raster());
    EXPECT_EQ(in.raster()->name, "photo");
    EXPECT_TRUE(QFileInfo(QString::fromStdString(in.raster()->file)).isAbsolute());
    EXPECT_EQ(in.raster()->camera->width, 60);
    return Outcome();
  };
  EXPECT_TRUE(apply());
  document.rm()->shot = Shotm();
  next = [](const Inputs& in, Progress&) {
    EXPECT_FALSE(in.raster()->camera) << "an image that nobody has aligned";
    return Outcome();
  };
  EXPECT_TRUE(apply());
}

TEST_F(HostPlugin, FailuresLeaveASentenceAndNothingElse) {
  next = [](const Inputs&, Progress&) -> Outcome { throw UserError("Do this."); };
  expect_failure("Do this.");
  next = [](const Inputs&, Progress&) -> Outcome { throw std::bad_alloc(); };
  expect_failure("The memory is used up; choose a lower resolution or meshes with fewer faces.");
  next = [](const Inputs&, Progress&) -> Outcome { throw std::out_of_range("vector"); };
  expect_failure("The filter met an internal error (vector); nothing was changed, please report it with the input.");
  next = [](const Inputs&, Progress&) -> Outcome { throw 7; };
  expect_failure("The filter met an internal error; nothing was changed, please report it with the input.");
}

TEST_F(HostPlugin, CancellingChangesNothing) {
  next = [](const Inputs&, Progress& progress) {
    progress.stage("working", 0, 100);
    ADD_FAILURE() << "went on";
    return Outcome();
  };
  expect_failure("Cancelled; nothing was changed.", [](const int, const char*) { return false; });
}

TEST_F(HostPlugin, ValuesThatNoFilterCanUseAreNamed) {
  next = [](const Inputs& in, Progress&) {
    in.integer("Integer"), in.number("Number"), in.length("Length"), in.choice("Choice"), in.point("Point");
    return Outcome();
  };
  list.setValue("Integer", IntValue(-2));
  expect_failure("Integer is -2; give a value from 0 to 10.");
  list.setValue("Integer", IntValue(2));
  list.setValue("Number", FloatValue(std::nanf("")));
  expect_failure("Number is not a number; give one.");
  list.setValue("Number", FloatValue(1));
  list.setValue("Length", test::LengthValue(-1));
  expect_failure("Length is -1; give a value of at least 0.");
  list.setValue("Length", test::LengthValue(9));
  list.setValue("Choice", test::ChoiceValue(2));
  expect_failure("Choice has no value 2; give one from 0 to 1.");
  list.setValue("Choice", test::ChoiceValue(0));
  list.setValue("Point", test::PointValue(Point3m(0, INFINITY, 0)));
  expect_failure("Point is not a point; give three numbers.");
}

TEST_F(HostPlugin, ValuesThatAScriptLeavesOutAreTheDefaults) {
  next = [](const Inputs& in, Progress&) {
    EXPECT_EQ(in.integer("Integer"), 3);
    EXPECT_EQ(in.number("Number"), 0.25);
    EXPECT_EQ(in.layer("B").name(), "two");
    EXPECT_EQ(in.point("Point"), Vec3(3, 4, 0));
    return Outcome();
  };
  RichParameterList some;
  some.addParam(RichFloat("Number", 0.25f));
  EXPECT_EQ(test::run(plugin, document, some, log, nullptr), "");
}

TEST_F(HostPlugin, ValuesOfTheWrongTypeAreNamed) {
  next = [](const Inputs& in, Progress&) {
    in.number("Number");
    return Outcome();
  };
  RichParameterList wrong;
  wrong.addParam(RichInt("Number", 1));
  wrong.addParam(RichBool("AllowFlaws", true));
  EXPECT_EQ(test::run(plugin, document, wrong, log, nullptr),
            "The script gives Number as a RichInt; take its line from the filter's template in scripts/.");
}

TEST_F(HostPlugin, FiguresAreLogged) {
  next = [](const Inputs&, Progress& progress) {
    log_value(progress, "cost", 1234567.25);
    return Outcome();
  };
  EXPECT_TRUE(apply());
  EXPECT_EQ(last_line(), "cost: 1234567.25");
}

/// The lines of a run, and how they were meant.
using Lines = std::vector<std::pair<int, std::string>>;
Lines lines_of(const GLLogStream& log) {
  Lines lines;
  for (const auto& line : log.logStringList()) lines.emplace_back(line.first, line.second.toStdString());
  return lines;
}

TEST_F(HostPlugin, WarningsComeLast) {
  next = [](const Inputs&, Progress& progress) {
    log_value(progress, "warning", "Look here.");
    log_value(progress, "cost", 1);
    return Outcome();
  };
  EXPECT_TRUE(apply());
  EXPECT_EQ(lines_of(log), (Lines{{GLLogStream::FILTER, "cost: 1"}, {GLLogStream::WARNING, "warning: Look here."}}));
  next = [](const Inputs&, Progress& progress) -> Outcome {
    log_value(progress, "warning", "Look here.");
    throw UserError("Do this.");
  };
  expect_failure("Do this.");
}

/// A result that is compared with both layers.
Outcome composed(const Inputs& in, Mesh mesh) {
  Outcome out;
  out.layers = {{"Result", std::move(mesh), true, {}, {{in.layer("A"), in.layer("B")}}}};
  out.current = 0;
  return out;
}

TEST_F(HostPlugin, ResultsAreComparedWithTheirInputs) {
  next = [](const Inputs& in, Progress&) { return composed(in, triangle()); };
  ASSERT_TRUE(apply());
  EXPECT_EQ(lines_of(log), (Lines{{GLLogStream::FILTER, "result_pieces: 1"},
                                  {GLLogStream::FILTER, "result_borders: 1"},
                                  {GLLogStream::FILTER, "result_nonmanifold: 0"},
                                  {GLLogStream::FILTER, "result_pinches: 0"},
                                  {GLLogStream::FILTER, "result_flipped: 0"},
                                  {GLLogStream::FILTER, "result_crossings: 0"},
                                  {GLLogStream::FILTER, "input_pieces: 2"},
                                  {GLLogStream::FILTER, "input_borders: 2"},
                                  {GLLogStream::FILTER, "input_nonmanifold: 0"},
                                  {GLLogStream::FILTER, "input_pinches: 0"},
                                  {GLLogStream::FILTER, "input_flipped: 0"},
                                  {GLLogStream::FILTER, "input_crossings: 0"}}));
}

Mesh two_flawed_triangles() {
  Mesh m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, -1}, {0.3, 0.2, -1}, {0.2, 0.2, 1}};
  m.faces = {{0, 1, 2}, {3, 4, 5}};
  return m;
}

TEST_F(HostPlugin, AResultThatIsWorseEndsInAWarning) {
  next = [](const Inputs& in, Progress&) { return composed(in, two_flawed_triangles()); };
  ASSERT_TRUE(apply());
  EXPECT_EQ(log.logStringList().last().first, int(GLLogStream::WARNING));
  EXPECT_EQ(last_line(),
            "warning: The result \"Result\" has 1 pair of crossing faces, which its inputs do not have; look at it "
            "before you use it.");
  EXPECT_EQ(layer_count(), 3) << "it is added all the same";
}

TEST_F(HostPlugin, WithoutAllowFlawsItIsAFailure) {
  next = [](const Inputs& in, Progress&) { return composed(in, two_flawed_triangles()); };
  list.setValue("AllowFlaws", BoolValue(false));
  expect_failure(
      "The result \"Result\" has 1 pair of crossing faces, which its inputs do not have; change the parameters, or set "
      "AllowFlaws to look at it.");
  next = [](const Inputs& in, Progress&) { return composed(in, triangle()); };
  EXPECT_TRUE(apply()) << "nothing is wrong with this one";
}

TEST_F(HostPlugin, FilesComeWithTheLayersOrNotAtAll) {
  QFile::remove("made.txt");
  const auto made = [](Mesh mesh) {
    return [mesh = std::move(mesh)](const Inputs& in, Progress&) {
      Outcome out = composed(in, mesh);
      out.files->add("made.txt", "made");
      return out;
    };
  };
  list.setValue("AllowFlaws", BoolValue(false));
  next = made(two_flawed_triangles());
  EXPECT_FALSE(apply());
  EXPECT_FALSE(QFileInfo::exists("made.txt"));
  next = made(triangle());
  EXPECT_TRUE(apply());
  EXPECT_TRUE(QFileInfo::exists("made.txt"));
  EXPECT_EQ(layer_count(), 3);
  // A file that cannot be put in place takes its layers with it.
  QFile::remove("made.txt");
  next = [&](const Inputs& in, Progress&) {
    QDir().mkpath("made.txt/in_the_way");
    Outcome out = composed(in, triangle());
    out.files->add("made.txt", "made");
    return out;
  };
  EXPECT_FALSE(apply());
  EXPECT_EQ(layer_count(), 3);
  QDir("made.txt").removeRecursively();
}

TEST_F(HostPlugin, AResultThatSaysNothingOfInputsIsToBeFlawless) {
  next = [](const Inputs&, Progress&) {
    Outcome out;
    out.layers = {{"Result", triangle()}};
    return out;
  };
  list.setValue("AllowFlaws", BoolValue(false));
  expect_failure("The result \"Result\" has 1 open border; change the parameters, or set AllowFlaws to look at it.");
}

TEST_F(HostPlugin, AModelAsItIsIsNotJudged) {
  next = [](const Inputs&, Progress&) {
    Outcome out;
    out.layers = {{"Result", two_flawed_triangles(), true, {}, {{}, {}, true}}};
    out.current = 0;
    return out;
  };
  list.setValue("AllowFlaws", BoolValue(false));
  EXPECT_TRUE(apply());
  EXPECT_EQ(last_line(), "result_crossings: 1");
}

TEST_F(HostPlugin, AResultThatIsNoMeshIsNeverAdded) {
  next = [](const Inputs& in, Progress&) {
    Mesh m = triangle();
    m.faces[0][2] = 3;
    return composed(in, m);
  };
  expect_failure(
      "The filter met an internal error (a face without its vertex); nothing was changed, please report it with the "
      "input.");
}

TEST_F(HostPlugin, NoLayerIsPlacedWhereNothingIs) {
  next = [](const Inputs& in, Progress&) {
    Outcome out;
    out.placed = {{in.layer("A"), Eigen::Matrix4d::Constant(NAN), true}};
    return out;
  };
  expect_failure(
      "The filter met an internal error (a matrix that is not finite); nothing was changed, please report it with the "
      "input.");
}

TEST_F(HostPlugin, SizesThatCannotBeComputedWithAreRefusedAtTheDoor) {
  next = [](const Inputs& in, Progress&) {
    in.length("Length"), in.point("Point"), in.layer("A").mesh();
    return Outcome();
  };
  list.setValue("Length", test::LengthValue(1e22f));
  expect_failure("Length is 1e+22, too large to compute with; give at most 1e+12.");
  list.setValue("Length", test::LengthValue(0));
  list.setValue("Point", test::PointValue(Point3m(0, -3e38f, 0)));
  expect_failure("Point is 3e+38, too large to compute with; give at most 1e+12.");
  list.setValue("Point", test::PointValue(Point3m(0, 0, 0)));
  EXPECT_TRUE(apply());
  layer(0).cm.vert[2].P() = {0, 1e21f, 0};
  EXPECT_EQ(failure(),
            "The layer \"one\" has coordinates of 1e+21, too large to compute with; scale it down to 1e+12 or less.");
}

TEST_F(HostPlugin, LengthsReachNoFartherThanTheLayers) {
  next = [](const Inputs& in, Progress&) {
    EXPECT_EQ(in.length("Length"), 5e6) << "the diagonal, a million times";
    return Outcome();
  };
  list.setValue("Length", test::LengthValue(1e11f));
  EXPECT_TRUE(apply());
}

/// A ball of 0.24 m as a survey has it, in metres.
TEST_F(HostPlugin, AScanFarFromTheOriginIsRefusedInWords) {
  const auto place = [&](const Mesh& mesh, const Vec3& at) {
    CMeshO& m = layer(0).cm;
    m.Clear();
    vcg::tri::Allocator<CMeshO>::AddVertices(m, mesh.vertices.size());
    for (int i = 0; i < mesh.vertex_count(); ++i) {
      const Vec3 p = mesh.vertices[i] + at;
      m.vert[i].P() = {float(p.x()), float(p.y()), float(p.z())};
    }
    for (const Triangle& f : mesh.faces) vcg::tri::Allocator<CMeshO>::AddFace(m, f[0], f[1], f[2]);
  };
  next = [](const Inputs& in, Progress&) {
    in.layer("A").mesh();
    return Outcome();
  };
  const Mesh ball = parts::test::sphere({0, 0, 0}, 0.12);
  place(ball, {0, 0, 0});
  EXPECT_TRUE(apply());
  place(ball, {100, 50, 7});
  EXPECT_TRUE(apply());
  place(ball, {455812, 5423377, 118});
  EXPECT_EQ(
      failure(),
      "The coordinates of the layer \"one\" are rounded to 0.5, as they lie far from the origin, which is too coarse "
      "for a model of size 0.25; move it to the origin in the program that made it, and load it again.");
  // Brought back by a matrix it is as coarse as before.
  layer(0).cm.Tr.SetTranslate(-455812, -5423377, -118);
  EXPECT_FALSE(apply());
}

TEST_F(HostPlugin, TheHostReloadsTexturesOnlyOfAResultThatHasThem) {
  next = [](const Inputs&, Progress&) {
    Outcome out;
    out.layers = {{"Result", triangle()}};
    out.layers[0].mesh.textures = {QDir("a.png").absolutePath().toStdString()};
    out.current = 0;
    return out;
  };
  ASSERT_TRUE(QImage(2, 2, QImage::Format_RGB32).save("a.png"));
  EXPECT_FALSE(plugin.getClass(action()) & api::FilterPlugin::Texture);
  ASSERT_TRUE(apply());
  EXPECT_TRUE(plugin.getClass(action()) & api::FilterPlugin::Texture);
}

}  // namespace

std::vector<Filter> filters() {
  return {{"Group: Test", "test", Menu::Remeshing, "Help.", parameters,
           [](const Inputs& in, Progress& progress) { return next(in, progress); }}};
}

}  // namespace parts::host

int main(int argc, char** argv) {
  qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
