// SPDX-License-Identifier: GPL-3.0-or-later
// The plugin class over a table of test filters: parameters, failures, commits.
#include <gtest/gtest.h>

#include <QApplication>
#include <QFileInfo>

#include "parts/base/error.h"
#include "parts/host/plugin.h"

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
      layer->UpdateBoxAndNormals();
    }
    document.setCurrentMesh(0);
    plugin.setLog(&log);
    plugin.initParameterSet(action(), document, list);
  }
  QAction* action() { return plugin.actions()[0]; }
  bool apply(vcg::CallBackPos* callback = nullptr) { return plugin.applyFilter(action(), document, list, callback); }
  std::string last_line() {
    return log.logStringList().isEmpty() ? "" : log.logStringList().last().second.toStdString();
  }
  /// The run fails with this sentence, which the log has too, and nothing has changed.
  void expect_failure(const std::string& sentence, vcg::CallBackPos* callback = nullptr) {
    EXPECT_FALSE(apply(callback));
    EXPECT_EQ(plugin.errorMsg().toStdString(), sentence);
    EXPECT_EQ(last_line(), sentence);
    ASSERT_EQ(document.meshList.size(), 2);
    EXPECT_EQ(document.mm()->id(), 0);
    for (MeshModel* layer : document.meshList) {
      EXPECT_TRUE(layer->isVisible());
      EXPECT_EQ(layer->cm.vert[1].P(), vcg::Point3f(3, 0, 0));
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
  EXPECT_EQ(dynamic_cast<const RichAbsPerc&>(list.getParameterByName("Length")).max, 5) << "the diagonal";
}

TEST_F(HostPlugin, ADocumentWithoutLayers) {
  MeshDocument empty;
  RichParameterList of_empty;
  plugin.initParameterSet(action(), empty, of_empty);
  EXPECT_EQ(of_empty.size(), list.size());
  EXPECT_EQ(dynamic_cast<const RichAbsPerc&>(of_empty.getParameterByName("Length")).max, 1);
  next = [](const Inputs& in, Progress&) {
    in.layer("A");
    return Outcome();
  };
  EXPECT_FALSE(plugin.applyFilter(action(), empty, of_empty, nullptr));
  EXPECT_EQ(plugin.errorMsg(), "There is no layer for A; load a mesh and choose it.");
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
  ASSERT_EQ(document.meshList.size(), 4);
  EXPECT_EQ(document.mm()->label(), "Result");
  EXPECT_EQ(document.mm()->cm.fn, 1);
  EXPECT_FALSE(document.meshList[0]->isVisible());
  EXPECT_TRUE(document.meshList[2]->isVisible());
  EXPECT_FALSE(document.meshList[3]->isVisible());
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
  ASSERT_EQ(document.rasterList.size(), 1);
  ASSERT_TRUE(document.rm());
  EXPECT_EQ(document.rm()->label(), "photo");
  EXPECT_TRUE(document.meshList[2]->hasDataMask(MeshModel::MM_CAMERA));
  EXPECT_TRUE(document.meshList[2]->cm.shot.IsValid());
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
  list.setValue("Length", AbsPercValue(-1));
  expect_failure("Length is -1; give a value of at least 0.");
  list.setValue("Length", AbsPercValue(9));
  list.setValue("Choice", EnumValue(2));
  expect_failure("Choice has no value 2; give one from 0 to 1.");
  list.setValue("Choice", EnumValue(0));
  list.setValue("Point", Point3fValue(vcg::Point3f(0, INFINITY, 0)));
  expect_failure("Point is not a point; give three numbers.");
}

TEST_F(HostPlugin, ValuesOfTheWrongTypeAreNamed) {
  next = [](const Inputs& in, Progress&) {
    in.number("Number");
    return Outcome();
  };
  RichParameterList wrong;
  wrong.addParam(RichInt("Number", 1));
  EXPECT_FALSE(plugin.applyFilter(action(), document, wrong, nullptr));
  EXPECT_EQ(plugin.errorMsg(),
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

TEST_F(HostPlugin, TheHostReloadsTexturesOnlyOfAResultThatHasThem) {
  next = [](const Inputs&, Progress&) {
    Outcome out;
    out.layers = {{"Result", triangle()}};
    out.layers[0].mesh.textures = {"/a.png"};
    out.current = 0;
    return out;
  };
  EXPECT_FALSE(plugin.getClass(action()) & MeshFilterInterface::Texture);
  ASSERT_TRUE(apply());
  EXPECT_TRUE(plugin.getClass(action()) & MeshFilterInterface::Texture);
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
