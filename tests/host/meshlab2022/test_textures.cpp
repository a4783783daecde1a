// SPDX-License-Identifier: GPL-3.0-or-later
// Textures of layers, which this host has as images in memory.
#include <gtest/gtest.h>

#include <QDir>
#include <QFileInfo>

#include "host_api.h"

namespace parts::host {
namespace {

QImage image(const QColor& color) {
  QImage picture(4, 2, QImage::Format_RGB32);
  picture.fill(color);
  return picture;
}

TEST(Textures, BecomeFilesForTheLengthOfARun) {
  MeshDocument document;
  MeshModel *a = document.addNewMesh("", "a"), *b = document.addNewMesh("", "b");
  a->addTexture("skin.png", image(Qt::red));
  a->addTexture("eye.jpg", image(Qt::blue));
  b->addTexture("skin.png", image(Qt::green));
  const QString red = QString::fromStdString(api::texture_file(*a, "skin.png"));
  const QString green = QString::fromStdString(api::texture_file(*b, "skin.png"));
  EXPECT_EQ(QImage(red).pixelColor(0, 0), QColor(Qt::red));
  EXPECT_EQ(QImage(green).pixelColor(0, 0), QColor(Qt::green)) << "of one name, but another image";
  EXPECT_EQ(QString::fromStdString(api::texture_file(*a, "skin.png")), red) << "made once";
  api::forget_texture_files();
  EXPECT_FALSE(QFileInfo::exists(red));
  EXPECT_FALSE(QFileInfo::exists(green));
}

TEST(Textures, OfAResultHaveTheirNamesAndAreUnique) {
  MeshDocument document;
  MeshModel *a = document.addNewMesh("", "a"), *b = document.addNewMesh("", "b"), *c = document.addNewMesh("", "c");
  a->addTexture("skin.jpg", image(Qt::red));
  b->addTexture("skin.jpg", image(Qt::green));
  ASSERT_TRUE(image(Qt::blue).save("made.png"));
  api::set_textures({api::texture_file(*a, "skin.jpg"), api::texture_file(*b, "skin.jpg"),
                     QDir("made.png").absolutePath().toStdString()},
                    *c);
  EXPECT_EQ(c->cm.textures, (std::vector<std::string>{"skin.jpg", "skin_2.jpg", "made.png"}));
  EXPECT_EQ(c->getTexture("skin_2.jpg").pixelColor(0, 0), QColor(Qt::green));
  EXPECT_EQ(c->getTexture("made.png").pixelColor(0, 0), QColor(Qt::blue));
  api::set_textures({"/missing.png"}, *b);
  EXPECT_FALSE(b->getTexture("missing.png").isNull()) << "what the host shows in its place";
  api::forget_texture_files();
}

TEST(Textures, ThatAreStillThoseBesideTheMeshAreTheseFiles) {
  QDir().mkpath("beside");
  ASSERT_TRUE(image(Qt::red).save("beside/skin.png"));
  const QString file = QDir("beside").absoluteFilePath("skin.png");
  MeshDocument document;
  MeshModel* layer = document.addNewMesh("", "layer");
  layer->setFileName(QDir("beside").absoluteFilePath("a.ply"));
  layer->addTexture("skin.png", QImage(file));
  EXPECT_EQ(QString::fromStdString(api::texture_file(*layer, "skin.png")), file);
  api::forget_texture_files();
  EXPECT_TRUE(QFileInfo::exists(file));
  layer->setTexture("skin.png", image(Qt::blue));  // by a filter of the host
  EXPECT_NE(QString::fromStdString(api::texture_file(*layer, "skin.png")), file);
  api::forget_texture_files();
}

TEST(Textures, WithoutAnImageAreLookedForBesideTheMesh) {
  MeshDocument document;
  MeshModel* layer = document.addNewMesh("", "layer");
  layer->setFileName("/models/a.obj");
  EXPECT_EQ(api::texture_file(*layer, "skin.png"), "/models/skin.png");
}

}  // namespace
}  // namespace parts::host
