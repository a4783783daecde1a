// SPDX-License-Identifier: GPL-3.0-or-later
// Textures of layers, which this host has as names of files.
#include <gtest/gtest.h>

#include <QDir>

#include "host_api.h"

namespace parts::host {
namespace {

TEST(Textures, AreFoundBesideTheMeshFile) {
  QDir().mkpath("models");
  QFile skin("models/skin.png");
  ASSERT_TRUE(skin.open(QIODevice::WriteOnly));
  MeshDocument document;
  MeshModel* layer = document.addNewMesh("", "layer");
  layer->setFileName(QDir("models").absoluteFilePath("a.obj"));
  EXPECT_EQ(api::texture_file(*layer, "skin.png"), QDir("models").absoluteFilePath("skin.png").toStdString());
  EXPECT_EQ(api::texture_file(*layer, "other.png"), QDir("other.png").absolutePath().toStdString());
}

TEST(Textures, ComeBackByTheirNames) {
  MeshDocument document;
  MeshModel* layer = document.addNewMesh("", "layer");
  const std::string file = QDir("a.png").absolutePath().toStdString();
  api::set_textures({file}, *layer);
  EXPECT_EQ(api::texture_file(*layer, layer->cm.textures.at(0)), file);
}

}  // namespace
}  // namespace parts::host
