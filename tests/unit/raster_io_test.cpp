// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/raster_io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "parts/base/error.h"
#include "parts/base/memory.h"
#include "parts/io/image_head.h"
#include "parts/io/pfm.h"
#include "support/folder.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

/// Files of a test, in a folder of its own.
struct RasterIo : test::Folder {
  ~RasterIo() override {
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.is_regular_file() && entry.file_size() < 65536)
        test::keep_for_corpus("image", test::contents(entry.path()));
  }

  std::string save(const std::string& name, const cv::Mat& image) const {
    EXPECT_TRUE(cv::imwrite(at(name), image));
    return at(name);
  }
  std::string text(const std::string& name, const std::string& bytes) const {
    std::ofstream(at(name), std::ios::binary) << bytes;
    return at(name);
  }
};

/// The sentence with which a call fails; it is one, and names the file.
template <class Call>
std::string sentence(const Call& call) {
  const std::string what = test::sentence(call);
  EXPECT_NE(what.find('"'), what.npos) << what;
  return what;
}

#define EXPECT_SAYS(words, call) \
  EXPECT_NE(sentence([&] { call; }).find(words), std::string::npos) << sentence([&] { call; })

cv::Mat ramp() {
  cv::Mat depth(5, 7, CV_32F);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x) depth.at<float>(y, x) = 1.25f + 0.1f * float(x) + 1e-3f * float(y);
  depth.at<float>(0, 0) = kNaN;
  return depth;
}

TEST_F(RasterIo, DepthComesBackBitForBit) {
  for (const char* name : {"a.tif", "a.TIFF", "a.pfm"}) {
    io::write_depth(ramp(), at(name));
    const cv::Mat back = io::read_depth(at(name));
    ASSERT_EQ(back.size(), cv::Size(7, 5));
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 7; ++x) {
        const float was = ramp().at<float>(y, x), is = back.at<float>(y, x);
        ASSERT_TRUE(was == is || (std::isnan(was) && std::isnan(is))) << name << " " << x << " " << y;
      }
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 3) << "no drafts are left";
}

TEST_F(RasterIo, BackgroundIsZeroNanAndInfinity) {
  cv::Mat depth = ramp();
  depth.at<float>(1, 1) = 0, depth.at<float>(1, 2) = kInf, depth.at<float>(1, 3) = -kInf;
  const cv::Mat back = io::read_depth(save("a.tif", depth));
  for (int x = 1; x <= 3; ++x) EXPECT_TRUE(std::isnan(back.at<float>(1, x)));
  EXPECT_EQ(cv::countNonZero(io::depth_mask(back)), 35 - 4);
}

TEST_F(RasterIo, ScaledPngOf16Bits) {
  cv::Mat raw(3, 4, CV_16U, cv::Scalar(1500));
  raw.at<std::uint16_t>(0, 0) = 0;
  raw.at<std::uint16_t>(2, 3) = 65535;
  const cv::Mat depth = io::read_depth(save("a.png", raw), 0.001);
  EXPECT_TRUE(std::isnan(depth.at<float>(0, 0)));
  EXPECT_FLOAT_EQ(depth.at<float>(1, 1), 1.5f);
  EXPECT_FLOAT_EQ(depth.at<float>(2, 3), 65.535f);
  cv::Mat thrice;
  cv::merge(std::vector<cv::Mat>(3, raw), thrice);
  EXPECT_FLOAT_EQ(io::read_depth(save("b.png", thrice)).at<float>(1, 1), 1500);
}

TEST_F(RasterIo, WhatIsNoDepth) {
  EXPECT_SAYS("8 bits", io::read_depth(save("grey.png", cv::Mat(4, 4, CV_8U, cv::Scalar(7)))));
  EXPECT_SAYS("channels", io::read_depth(save("rgb.png", cv::Mat(4, 4, CV_16UC3, cv::Scalar(7, 8, 9)))));
  EXPECT_SAYS("Z channel", io::read_depth(save("zero.tif", cv::Mat(4, 4, CV_32F, cv::Scalar(0)))));
  EXPECT_SAYS("background everywhere", io::read_depth(save("nan.tif", cv::Mat(4, 4, CV_32F, cv::Scalar(kNaN)))));
  EXPECT_SAYS("background everywhere", io::read_depth(save("inf.pfm", cv::Mat(4, 4, CV_32F, cv::Scalar(kInf)))));
  EXPECT_SAYS(".pfm", io::write_depth(ramp(), at("a.png")));
  EXPECT_SAYS("cannot be written", io::write_depth(ramp(), at("no/such/folder/a.tif")));
  fs::create_directory(at("folder.tif"));
  EXPECT_SAYS("cannot be written", io::write_depth(ramp(), at("folder.tif")));
}

TEST_F(RasterIo, GreyColourAndAlphaOf8And16Bits) {
  for (int depth : {CV_8U, CV_16U}) {
    const double unit = depth == CV_8U ? 1 : 257;
    cv::Mat colour(4, 6, CV_MAKETYPE(depth, 4), cv::Scalar(10 * unit, 20 * unit, 30 * unit, 255 * unit));
    colour.col(0).setTo(cv::Scalar(10 * unit, 20 * unit, 30 * unit, 0));
    const io::Image image = io::read_image(save("a.png", colour));
    ASSERT_EQ(image.color.type(), CV_8UC3);
    EXPECT_EQ(image.color.at<cv::Vec3b>(2, 2), cv::Vec3b(10, 20, 30));
    EXPECT_TRUE(image.has_alpha);
    EXPECT_EQ(cv::countNonZero(image.mask), 20);

    const io::Image grey = io::read_image(save("g.png", cv::Mat(4, 6, CV_MAKETYPE(depth, 1), cv::Scalar(50 * unit))));
    EXPECT_EQ(grey.color.at<cv::Vec3b>(0, 0), cv::Vec3b(50, 50, 50));
    EXPECT_FALSE(grey.has_alpha);
    EXPECT_EQ(cv::countNonZero(grey.mask), 24);
  }
  cv::Mat opaque(4, 6, CV_8UC4, cv::Scalar(1, 2, 3, 255));
  EXPECT_FALSE(io::read_image(save("o.png", opaque)).has_alpha) << "an alpha that hides nothing says nothing";
}

TEST_F(RasterIo, WhatIsNoImage) {
  EXPECT_SAYS("does not exist", io::read_image(at("missing.png")));
  EXPECT_SAYS("folder", io::read_image(folder.string()));
  EXPECT_SAYS("is empty", io::read_image(text("empty.png", "")));
  EXPECT_SAYS("cannot be read", io::read_image(text("words.png", "not an image at all, only words")));
  const std::string whole = save("whole.png", cv::Mat(64, 64, CV_8UC3, cv::Scalar(1, 2, 3)));
  std::ifstream in(whole, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_SAYS("cannot be read", io::read_image(text("cut.png", bytes.substr(0, bytes.size() / 2))));
  EXPECT_SAYS("transparent", io::read_image(save("clear.png", cv::Mat(4, 4, CV_8UC4, cv::Scalar(1, 2, 3, 0)))));
  EXPECT_SAYS("beyond 0 to 1", io::read_image(save("depth.tif", ramp())));
  EXPECT_SAYS("ending", io::write_image(cv::Mat(4, 4, CV_8U), at("a.txt")));
}

/// A PNG head that claims a size; nothing follows.
std::string png_of(std::uint32_t width, std::uint32_t height) {
  std::string s = std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  for (std::uint32_t n : {width, height})
    for (int shift : {24, 16, 8, 0}) s += char(n >> shift & 255);
  return s + std::string("\x10\x06\0\0\0", 5) + std::string(40, '\0');
}

TEST_F(RasterIo, SizesAreToldBeforeAnythingIsAllocated) {
  EXPECT_SAYS("more than can be read", io::read_image(text("huge.png", png_of(2000000000, 2000000000))));
  if (available_memory().value_or(1e99) < 24e9) {
    EXPECT_SAYS("32000 x 32000 pixels, which need", io::read_image(text("large.png", png_of(32000, 32000))));
  }
  EXPECT_SAYS("more than can be read", io::read_depth(text("huge.pfm", "Pf\n900000 900000\n-1\n")));
}

TEST_F(RasterIo, HeadsOfTheFormats) {
  const cv::Mat colour(31, 57, CV_8UC3, cv::Scalar(1, 2, 3));
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.bmp", "a.ppm"}) {
    const auto head = io::read_image_head(InputFile(save(name, colour)));
    ASSERT_TRUE(head) << name;
    EXPECT_EQ(head->width, 57) << name;
    EXPECT_EQ(head->height, 31) << name;
  }
  for (const char* name : {"a.pfm", "b.tif"}) {
    const auto head = io::read_image_head(InputFile(save(name, ramp())));
    ASSERT_TRUE(head) << name;
    EXPECT_EQ(head->width, 7);
    EXPECT_EQ(head->bytes, 4);
    EXPECT_EQ(head->pfm, name[0] == 'a');
  }
  EXPECT_FALSE(io::read_image_head("II*"));
  EXPECT_FALSE(io::read_image_head(std::string("II*\0\xff\xff\xff\xff", 8)));
  EXPECT_FALSE(io::read_image_head("\xFF\xD8\xFF\xE0"));
  EXPECT_FALSE(io::read_image_head(std::string("II+\0\x08\0\0\0\xf0\xff\xff\xff\xff\xff\xff\xff", 16)))
      << "a directory at 2^64 - 16";
}

TEST_F(RasterIo, Masks) {
  cv::Mat half(4, 6, CV_8U, cv::Scalar(0));
  half.colRange(0, 3).setTo(255);
  EXPECT_EQ(cv::countNonZero(io::read_mask(save("m.png", half))), 12);
  EXPECT_EQ(cv::countNonZero(io::read_mask(save("m16.png", cv::Mat(4, 6, CV_16U, cv::Scalar(65535))))), 24);
  cv::Mat alpha = io::with_alpha(cv::Mat(4, 6, CV_8UC3, cv::Scalar(0, 0, 0)), half);
  EXPECT_EQ(cv::countNonZero(io::read_mask(save("a.png", alpha))), 12) << "alpha says more than black";
  EXPECT_SAYS("6 x 4 pixels and its image 7 x 4", io::read_mask(at("m.png"), {7, 4}));
  EXPECT_SAYS("black everywhere", io::read_mask(save("b.png", cv::Mat(4, 6, CV_8U, cv::Scalar(0)))));
}

/// A JPEG or PNG with an EXIF block put in.
std::string with_exif(const std::string& bytes, char orientation, bool png) {
  std::string block("II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0", 26);
  block[18] = orientation;
  if (!png)
    return bytes.substr(0, 2) +
           std::string(
               "\xFF\xE1\0\x22"
               "Exif\0\0",
               10) +
           block + bytes.substr(2);
  std::uint32_t crc = ~0u;
  const std::string chunk = "eXIf" + block;
  for (unsigned char c : chunk)
    for (int k = (crc ^= c, 0); k < 8; ++k) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  crc = ~crc;
  std::string sum;
  for (int shift : {24, 16, 8, 0}) sum += char(crc >> shift & 255);
  return bytes.substr(0, 33) + std::string("\0\0\0\x1a", 4) + chunk + sum + bytes.substr(33);
}

TEST_F(RasterIo, APhotographIsTurnedUprightOrNot) {
  // Its corner of another colour, and where EXIF's figure of the eight orientations has it.
  cv::Mat stored(16, 32, CV_8UC3, cv::Scalar(20, 20, 20));
  stored(cv::Rect(0, 0, 8, 8)).setTo(cv::Scalar(250, 250, 250));
  const cv::Point corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (const char* name : {"p.jpg", "p.png"}) {
    const std::string plain = save(name, stored);
    std::ifstream in(plain, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    EXPECT_EQ(io::read_image(plain).orientation, 1);
    for (int o = 1; o <= 8; ++o) {
      const std::string turned = text("t_" + std::string(name), with_exif(bytes, char(o), name[2] == 'p'));
      const io::Image upright = io::read_image(turned), as_stored = io::read_image(turned, io::Turn::AsStored);
      EXPECT_EQ(upright.orientation, o) << name;
      EXPECT_EQ(as_stored.orientation, o) << name;
      ASSERT_EQ(upright.color.size(), o < 5 ? cv::Size(32, 16) : cv::Size(16, 32)) << name << o;
      ASSERT_EQ(as_stored.color.size(), cv::Size(32, 16));
      const cv::Point p(corners[o - 1].x * (upright.color.cols - 1), corners[o - 1].y * (upright.color.rows - 1));
      EXPECT_GT(upright.color.at<cv::Vec3b>(p)[0], 200) << name << o;
      EXPECT_GT(as_stored.color.at<cv::Vec3b>(1, 1)[0], 200);
      EXPECT_GT(io::read_texture(turned).at<cv::Vec3b>(1, 1)[0], 200) << "as MeshLab shows it";
    }
  }
}

TEST_F(RasterIo, PfmOfEveryDialect) {
  const float numbers[] = {1, 2, 3, 4, 5, 6};
  const auto pfm = [&](const std::string& head, bool big, int times) {
    std::string bytes = head;
    for (float n : numbers)
      for (int k = 0; k < times; ++k) {
        char raw[4];
        std::memcpy(raw, &n, 4);
        if (big) std::reverse(raw, raw + 4);
        bytes.append(raw, 4);
      }
    return bytes;
  };
  const std::pair<const char*, std::string> files[] = {
      {"little.pfm", pfm("Pf\n3 2\n-1.0\n", false, 1)},    {"big.pfm", pfm("Pf\n3 2\n1.0\n", true, 1)},
      {"scaled.pfm", pfm("Pf\n3 2\n-0.0039\n", false, 1)}, {"comment.pfm", pfm("Pf\n# by x\n3 2\n-1\n", false, 1)},
      {"crlf.pfm", pfm("Pf 3 2 -1\n", false, 1)},          {"color.pfm", pfm("PF\n3 2\n-1\n", false, 3)},
  };
  for (const auto& [name, bytes] : files) {
    const cv::Mat depth = io::read_depth(text(name, bytes));
    ASSERT_EQ(depth.size(), cv::Size(3, 2)) << name;
    EXPECT_EQ(depth.at<float>(1, 0), 1) << name << ": the lowest row comes first";
    EXPECT_EQ(depth.at<float>(0, 2), 6) << name;
  }
  for (const char* bad : {"Pf\n3 2\n-1\n123", "Pf\n3 2\n0\n", "Pf\n1e300 2\n-1\n", "Pf\n-3 2\n-1\n", "Pf\n3", "Pf"})
    EXPECT_TRUE(io::parse_pfm(bad).empty()) << bad;
}

TEST_F(RasterIo, TimeAndMemoryGoWithTheSizeOfTheFile) {
  // 36 million pixels in a few kilobytes, of one bit each: sixty times that when it is decoded.
  const cv::Mat plain(6000, 6000, CV_8U, cv::Scalar(0));
  std::vector<uchar> bytes;
  cv::imencode(".png", plain, bytes, {cv::IMWRITE_PNG_BILEVEL, 1, cv::IMWRITE_PNG_COMPRESSION, 9});
  ASSERT_LT(bytes.size(), 50000u);
  EXPECT_SAYS("6000 x 6000 pixels, which no picture", io::read_image(text("bomb.png", {bytes.begin(), bytes.end()})));
  const std::string sparse = text("sparse.png", "");
  fs::resize_file(sparse, std::uintmax_t(3) << 30);
  EXPECT_SAYS("cannot be read as an image", io::read_image(sparse));
}

TEST_F(RasterIo, FilesAreOneOfSeveral) {
  const cv::Mat depth(4, 6, CV_32F, cv::Scalar(2)), image(4, 6, CV_8U, cv::Scalar(9));
  {
    OutputFiles files;
    io::add_depth(files, depth, at("d.tif"));
    io::add_image(files, image, at("i.png"));
    io::add_image(files, image, "");
    EXPECT_FALSE(fs::exists(at("d.tif")) || fs::exists(at("i.png")));
    EXPECT_SAYS("cannot be written", io::add_image(files, image, at("nowhere/m.png")));
  }
  EXPECT_TRUE(fs::is_empty(folder)) << "drafts are left";
  OutputFiles files;
  io::add_depth(files, depth, at("d.tif"));
  io::add_image(files, image, at("i.png"));
  files.commit();
  EXPECT_EQ(io::read_depth(at("d.tif")).at<float>(1, 1), 2);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);
  io::check_depth_output("");
  io::check_image_output(at("j.png"));
  EXPECT_FALSE(fs::exists(at("j.png")));
  EXPECT_SAYS("cannot be written", io::check_depth_output(at("nowhere/d.tif")));
  EXPECT_SAYS("no ending", io::check_depth_output(at("d.png")));
  EXPECT_SAYS("no ending", io::check_image_output(at("d.pfm")));
}

TEST_F(RasterIo, EveryFormatComesBack) {
  cv::Mat image(8, 8, CV_8UC3);
  for (int i = 0; i < 64; ++i) image.at<cv::Vec3b>(i / 8, i % 8) = cv::Vec3b(uchar(i * 3), uchar(255 - i), 7);
  for (const char* name : {"a.png", "a.PNG", "a.tif", "a.tiff", "a.bmp"}) {
    io::write_image(image, at(name));
    EXPECT_EQ(cv::norm(io::read_image(at(name)).color, image, cv::NORM_INF), 0) << name;
  }
  io::write_image(image, at("a.jpeg"));
  EXPECT_EQ(io::read_image(at("a.jpeg")).color.size(), image.size());
}

}  // namespace
}  // namespace parts
