#include "lambake/io/light_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "lambake/core/error.h"

namespace lambake {
namespace {

/// A file that lives as long as the test, named lights.json in a folder of its own.
class LightFile : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::vector<Light> read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return read_light_file(path_);
  }
  /// Reads one light; `members` is what stands between its braces.
  Light read_one(const std::string& members) { return read("{\"lights\": [{" + members + "}]}").at(0); }
  /// The message that reading ends with, without the path that begins it.
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const IoError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_EQ(message.rfind(path_ + ": ", 0), 0U) << message;
      return message.substr(path_.size() + 2);
    }
    return "accepted";
  }
  std::string refusal_of_one(const std::string& members) {
    return refusal("{\"lights\": [{" + members + "}]}");
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("lambake-test-lights-" + std::to_string(::getpid()));
  const std::string path_ = (folder_ / "lights.json").string();
};

TEST_F(LightFile, Directional_DirectionIsNormalised_IntensityMultipliesColour) {
  const Light light = read_one(R"("type": "directional", "name": "sun", "direction_to_light": [0, 3, 4],
                                  "color": [1, 0.5, 0], "intensity": 2)");
  EXPECT_EQ(light.type, LightType::directional);
  EXPECT_EQ(light.name, "sun");
  EXPECT_EQ(light.direction_to_light, glm::vec3(0, 0.6f, 0.8f));
  EXPECT_EQ(light.intensity, (LinearRgb{2, 1, 0}));
}

TEST_F(LightFile, Point_HasInverseSquareFalloffAndNoRange_UnlessSaid) {
  const Light plain = read_one(R"("type": "point", "position": [1, 2, 3])");
  EXPECT_EQ(plain.type, LightType::point);
  EXPECT_EQ(plain.position, glm::vec3(1, 2, 3));
  EXPECT_EQ(plain.intensity, (LinearRgb{1, 1, 1}));
  EXPECT_EQ(plain.decay, 2);
  EXPECT_EQ(plain.range, 0);
  const Light light = read_one(R"("type": "point", "position": [0, 0, 0], "decay": 0.5, "range": 7)");
  EXPECT_EQ(light.decay, 0.5f);
  EXPECT_EQ(light.range, 7);
}

TEST_F(LightFile, Spot_AnglesAreDegrees) {
  const Light light = read_one(R"("type": "spot", "position": [0, 5, 0], "direction": [0, -2, 0],
                                  "inner_cone_deg": 15, "outer_cone_deg": 30)");
  EXPECT_EQ(light.type, LightType::spot);
  EXPECT_EQ(light.spot_direction, glm::vec3(0, -1, 0));
  EXPECT_NEAR(light.inner_cone_rad, std::numbers::pi / 12, 1e-7);
  EXPECT_NEAR(light.outer_cone_rad, std::numbers::pi / 6, 1e-7);
}

TEST_F(LightFile, SeveralLights_KeepTheirOrder_NoneIsAllowed) {
  const std::vector<Light> lights = read(R"({"lights": [
    {"type": "point", "position": [0, 0, 0]}, {"type": "directional", "direction_to_light": [1, 0, 0]}]})");
  ASSERT_EQ(lights.size(), 2U);
  EXPECT_EQ(lights[0].type, LightType::point);
  EXPECT_EQ(lights[1].type, LightType::directional);
  EXPECT_TRUE(read(R"({"lights": []})").empty());
}

TEST_F(LightFile, TheModelsLights_AreReadable) {
  const std::vector<Light> lights = read_light_file(LAMBAKE_SOURCE_DIR "/meshes/quad_under_lamp.lights.json");
  ASSERT_EQ(lights.size(), 1U);
  EXPECT_EQ(lights[0].position, glm::vec3(0, 1, 0));
}

TEST_F(LightFile, UnknownKeys_AreRefusedByName) {
  EXPECT_EQ(refusal_of_one(R"("type": "point", "position": [0, 0, 0], "colour": [1, 1, 1])"),
            "/lights/0: expected one of the keys type, name, color, intensity, position, decay, range, found "
            "\"colour\"");
  EXPECT_NE(
      refusal_of_one(R"("type": "directional", "direction_to_light": [0, 1, 0], "range": 1)").find("range"),
      std::string::npos);
  EXPECT_EQ(refusal(R"({"lights": [], "cameras": []})"), "expected no key but \"lights\", found \"cameras\"");
}

TEST_F(LightFile, WrongValues_AreRefused_TellingThePlaceAndWhatWasExpected) {
  const std::string at_origin = R"("type": "point", "position": [0, 0, 0], )";
  EXPECT_EQ(refusal_of_one(at_origin + R"("decay": -1)"),
            "/lights/0/decay: expected a finite number of at least 0, found -1");
  EXPECT_EQ(refusal_of_one(at_origin + R"("intensity": "bright")"),
            "/lights/0/intensity: expected a finite number of at least 0, found \"bright\"");
  EXPECT_EQ(refusal_of_one(at_origin + R"("color": [1, -1, 0])"),
            "/lights/0/color/1: expected a finite number of at least 0, found -1");
  EXPECT_EQ(refusal_of_one(at_origin + R"("color": [1, 1])"),
            "/lights/0/color: expected three numbers, found [1,1]");
  EXPECT_EQ(refusal_of_one(at_origin + R"("name": 3)"), "/lights/0/name: expected a string, found 3");
  EXPECT_EQ(refusal_of_one(R"("type": "point")"),
            "/lights/0/position: expected three numbers, found nothing");
  EXPECT_EQ(refusal_of_one(R"("type": "laser")"),
            "/lights/0/type: expected \"directional\", \"point\" or \"spot\", found \"laser\"");
  EXPECT_EQ(refusal_of_one(R"("type": "directional", "direction_to_light": [0, 0, 0])"),
            "/lights/0/direction_to_light: expected a direction that is not zero, found [0,0,0]");
  EXPECT_EQ(refusal_of_one(R"("type": "spot", "position": [0, 0, 0], "direction": [0, 0, 1],
                              "inner_cone_deg": 50, "outer_cone_deg": 40)"),
            "/lights/0: expected cone angles 0 <= inner <= outer <= 90 degrees with outer above 0");
  EXPECT_EQ(refusal(R"({"lights": [7]})"), "/lights/0: expected an object, found 7");
}

TEST_F(LightFile, AKeyTwice_IsRefused_InOtherObjectsItIsNot) {
  EXPECT_EQ(refusal(R"({"lights": [{"type": "point", "position": [0, 0, 0], "decay": 1, "decay": 2}]})"),
            "expected each key once in an object, found \"decay\" twice");
}

TEST_F(LightFile, NumbersBeyondFloat_AreRefused) {
  for (const char* number : {"1e39", "-1e39", "1e400"})
    EXPECT_NE(refusal_of_one("\"type\": \"point\", \"position\": [0, 0, " + std::string(number) + "]"),
              "accepted")
        << number;
}

TEST_F(LightFile, DirectionsOfAnyFiniteLength_AreNormalised) {
  for (const char* direction : {"[0, 1e38, 0]", "[0, 1e-38, 0]", "[0, 1e-44, 0]"}) {
    const Light light =
        read_one("\"type\": \"directional\", \"direction_to_light\": " + std::string(direction));
    EXPECT_EQ(light.direction_to_light, glm::vec3(0, 1, 0)) << direction;
  }
}

TEST_F(LightFile, WhatIsNoLightsFile_IsRefused) {
  EXPECT_EQ(refusal("{}"), "expected {\"lights\": [...]}");
  EXPECT_EQ(refusal("[]"), "expected {\"lights\": [...]}");
  EXPECT_EQ(refusal(R"({"lights": {}})"), "expected {\"lights\": [...]}");
  EXPECT_EQ(refusal("").rfind("expected content", 0), 0U);
  EXPECT_EQ(refusal("{\n  \"lights\": [}").rfind("line 2, column 14: expected JSON: ", 0), 0U)
      << refusal("{\n  \"lights\": [}");
  EXPECT_EQ(refusal(R"({"lights": [1e999]})"), "expected JSON: number overflow parsing '1e999'");
  EXPECT_EQ(refusal("\xFF\xFE{"), "expected text in UTF-8, found UTF-16");
}

TEST_F(LightFile, ValuesOfAnySize_AreToldInAShortLine) {
  const std::string deep(200'000, '['), closed(200'000, ']'), wide(1'000'000, 'x');
  EXPECT_EQ(refusal(R"({"lights": [{"type": )" + deep + closed + "}]}"),
            "expected JSON nested at most 256 levels deep");
  for (const std::string& text : {R"({"lights": [{"type": ")" + wide + "\"}]}",
                                  R"({"lights": [{"type": "point", ")" + wide + "\": 1}]}",
                                  R"({"lights": [], ")" + wide + "\": 1}", R"({"lights": [)" + wide})
    EXPECT_LT(refusal(text).size(), 500U);
}

TEST_F(LightFile, EveryTruncatedPrefix_IsRefused) {
  const std::string whole = R"({"lights": [{"type": "point", "position": [1, 2, 3]}]})";
  ASSERT_EQ(refusal(whole), "accepted");
  for (std::size_t n = 0; n < whole.size(); ++n) EXPECT_NE(refusal(whole.substr(0, n)), "accepted") << n;
}

TEST_F(LightFile, AFileThatIsNotThere_IsRefused) {
  EXPECT_THROW(read_light_file(path_ + ".none"), IoError);
}

}  // namespace
}  // namespace lambake
