#include "lambake/io/image_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include "lambake/core/error.h"
#include "lambake/io/image_bytes.h"

namespace lambake {
namespace {

/// A folder of its own for one test, removed at its end.
class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              ("lambake-" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::size_t n_files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

/// All 256 values of a channel, and values out of [0,1].
Picture ramp() {
  Picture picture{32, 9, {}};
  for (int i = 0; i < 288; ++i) {
    const float v = srgb_decode(float(i) / 255);
    picture.pixels.push_back({v, 1 - v, 0.5f * v - 0.1f});
  }
  return picture;
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string contents(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void expect_srgb_rounded(const Image& image, const Picture& picture) {
  ASSERT_EQ(image.width, picture.width);
  ASSERT_EQ(image.height, picture.height);
  for (std::size_t i = 0; i < picture.n_pixels(); ++i) {
    const LinearRgb expected = to_linear(to_srgb8(picture.pixels[i]));
    const glm::vec4 found = image.pixel(i);
    ASSERT_NEAR(found.r, expected.r, 1e-6f) << i;
    ASSERT_NEAR(found.g, expected.g, 1e-6f) << i;
    ASSERT_NEAR(found.b, expected.b, 1e-6f) << i;
    ASSERT_EQ(found.a, 1.0f);
  }
}

TEST(ImageFile, PngWrittenThenRead_IsThePictureInSrgbSteps) {
  const Folder folder;
  write_picture(folder.file("a.png"), ramp());
  expect_srgb_rounded(read_image(folder.file("a.png")), ramp());
  EXPECT_EQ(folder.n_files(), 1u);
}

TEST(ImageFile, ExrWrittenThenRead_IsThePictureToTheBit) {
  const Folder folder;
  Picture picture = ramp();
  picture.pixels[7] = {1e-30f, 70000.0f, -3.0f};
  write_picture(folder.file("a.EXR"), picture);
  const Image image = read_image(folder.file("a.EXR"));
  ASSERT_EQ(image.width, picture.width);
  for (std::size_t i = 0; i < picture.n_pixels(); ++i)
    ASSERT_EQ((LinearRgb{image.pixels[i].r, image.pixels[i].g, image.pixels[i].b}), picture.pixels[i]);
  EXPECT_EQ(folder.n_files(), 1u);
}

TEST(ImageFile, EncodedPng_IsTheFileAndDecodesUnderAnyName) {
  const Folder folder;
  write_picture(folder.file("a.png"), ramp());
  const std::string png = encode_png(ramp());
  EXPECT_EQ(png, contents(folder.file("a.png")));
  expect_srgb_rounded(decode_image(bytes_of(png), "texture 3"), ramp());
  expect_srgb_rounded(decode_image(bytes_of(png), "lies.jpg"), ramp());
}

TEST(ImageFile, ManyThreadsAtOnce_FromTheFirstUseOn_GetTheSame) {
  std::vector<std::string> encoded(8);
  std::vector<Image> decoded(encoded.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < encoded.size(); ++i)
    threads.emplace_back([&, i] {
      encoded[i] = encode_png(ramp());
      decoded[i] = decode_image(bytes_of(encoded[i]), "of a thread");
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < encoded.size(); ++i) {
    EXPECT_EQ(encoded[i], encoded[0]);
    expect_srgb_rounded(decoded[i], ramp());
  }
}

TEST(ImageFile, AnyTruncatedPng_ThrowsOneLine) {
  const std::string png = encode_png(ramp());
  for (std::size_t n = 0; n < png.size(); ++n) {
    try {
      decode_image(bytes_of(png.substr(0, n)), "cut.png");
      FAIL() << n << " of " << png.size() << " bytes";
    } catch (const IoError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

std::string error_of(const std::string& bytes) {
  try {
    decode_image(bytes_of(bytes), "a picture");
  } catch (const IoError& error) {
    return error.what();
  }
  return "";
}

TEST(ImageFile, PngWhoseBytesHaveChanged_ThrowsAndPrintsNothing) {
  std::string png = encode_png(ramp());
  const std::size_t data = png.find("IDAT");
  png[data + 20] ^= 1;
  testing::internal::CaptureStderr();
  EXPECT_EQ(error_of(png), "a picture: byte " + std::to_string(data - 4) +
                               ": expected a chunk IDAT that fits its checksum, found another");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// libjpeg makes up the pixels of a file that ends early.
TEST(ImageFile, AnyTruncatedJpeg_ThrowsOneLine) {
  const std::string jpeg = contents(LAMBAKE_SOURCE_DIR "/tests/io/grey188.jpg");
  for (std::size_t n = 0; n < jpeg.size(); ++n) {
    const std::string message = error_of(jpeg.substr(0, n));
    EXPECT_NE(message, "") << n << " of " << jpeg.size() << " bytes";
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  EXPECT_EQ(error_of(jpeg + "what follows is no matter"), "");
}

TEST(ImageFile, PngThatPromisesAHugeSize_ThrowsWithoutAllocatingIt) {
  std::string png = encode_png(ramp());
  // Width and height of IHDR, and its CRC-32.
  for (const std::size_t at : {16u, 20u}) png.replace(at, 4, std::string("\x00\x01\x00\x00", 4));
  std::uint32_t crc = 0xffffffffu;
  for (std::size_t i = 12; i < 29; ++i) {
    crc ^= static_cast<unsigned char>(png[i]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  for (std::size_t i = 0; i < 4; ++i) png[29 + i] = static_cast<char>(~crc >> (24 - 8 * i));
  try {
    decode_image(bytes_of(png), "huge.png");
    FAIL();
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find("65536x65536"), std::string::npos) << error.what();
  }
}

TEST(ImageFile, Jpeg_IsDecodedFromSrgb) {
  const Image image = read_image(LAMBAKE_SOURCE_DIR "/tests/io/grey188.jpg");
  ASSERT_EQ(image.width, 16u);
  ASSERT_EQ(image.height, 8u);
  ASSERT_EQ(image.bytes.size(), image.n_pixels());
  for (std::size_t i = 0; i < image.n_pixels(); ++i)
    ASSERT_NEAR(image.pixel(i).g, srgb_decode(188 / 255.0f), 0.005f);
}

// The frame's header names the number of channels; a table before it has a marker that looks like one.
TEST(ImageFile, JpegOfFourChannels_IsToldByItsFrame) {
  const auto jpeg = [](char frame, char n_channels) {
    return std::string("\xff\xd8\xff\xc4\x00\x04\x04\x04\xff", 9) + frame +
           std::string("\x00\x14\x08\x00\x08\x00\x08", 7) + n_channels + std::string(12, '\4');
  };
  for (const char frame : {'\xc0', '\xc1', '\xc2'}) {
    EXPECT_TRUE(is_cmyk_jpeg(jpeg(frame, 4)));
    EXPECT_FALSE(is_cmyk_jpeg(jpeg(frame, 3)));
    EXPECT_FALSE(is_cmyk_jpeg(jpeg(frame, 1)));
  }
  EXPECT_FALSE(is_cmyk_jpeg(contents(LAMBAKE_SOURCE_DIR "/tests/io/grey188.jpg")));
}

TEST(ImageFile, NoImage_Throws) {
  EXPECT_THROW(decode_image({}, "empty"), IoError);
  EXPECT_THROW(decode_image(bytes_of("no picture at all"), "text.png"), IoError);
  EXPECT_THROW(read_image("no/such/file.png"), IoError);
}

TEST(ImageFile, FailedWrites_LeaveNothingBehind) {
  const Folder folder;
  EXPECT_THROW(write_picture(folder.file("a.gif"), ramp()), InvalidOption);
  EXPECT_THROW(write_picture(folder.file("none/a.png"), ramp()), IoError);
  EXPECT_THROW(write_picture(folder.file("none/a.exr"), ramp()), IoError);
  EXPECT_EQ(folder.n_files(), 0u);
}

}  // namespace
}  // namespace lambake
