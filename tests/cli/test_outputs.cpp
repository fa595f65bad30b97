// What outputs may replace, and what they must not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/models.h"
#include "cli/run_tool.h"

namespace lambake::test {
namespace {

TEST(CommandLine, OutputThatIsTheInput_IsRefusedWhatItsPathIs) {
  const ScratchFolder folder("itself");
  write_quad(folder / "in.off");
  ASSERT_EQ(run_tool(folder, "bake in.off -o lit.ply --quiet").exit_code, 0);
  std::filesystem::create_symlink(folder / "lit.ply", folder / "link.ply");
  const std::string bytes = read_bytes(folder / "lit.ply");
  for (const char* arguments :
       {"bake lit.ply -o lit.ply", "bake lit.ply -o a.glb -o ./lit.ply", "bake lit.ply -o link.ply",
        "bake link.ply -o lit.ply", "compare lit.ply -o ."}) {
    const ToolResult result = run_tool(folder, arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_NE(result.err.find("would replace the input"), std::string::npos) << result.err;
    EXPECT_EQ(count_lines(result.err), 1U) << result.err;
  }
  EXPECT_EQ(read_bytes(folder / "lit.ply"), bytes);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.glb"));
}

// Names that an output has, each of them of a file that the input needs.
TEST(CommandLine, WhatTheInputNeeds_IsNotReplaced) {
  const ScratchFolder folder("needed");
  write_quad(folder / "quad.off");
  ASSERT_EQ(run_tool(folder, "render quad.off --size 8x8 -o difference.png --quiet").exit_code, 0);
  ASSERT_EQ(run_tool(folder, "bake quad.off -o own.gltf --quiet").exit_code, 0);
  const std::string triangle = "usemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  std::ofstream(folder / "in.obj") << "mtllib lit.ply\n" << triangle;
  std::ofstream(folder / "lit.ply") << "newmtl m\nmap_Kd difference.png\n";
  std::ofstream(folder / "report.json")
      << R"({"lights": [{"type": "directional", "direction": [0, 0, -1]}]})";
  std::filesystem::create_directory(folder / "gltf");
  nlohmann::json gltf = nlohmann::json::parse(read_bytes(folder / "own.gltf"));
  gltf["images"] = {{{"uri", "per%5Fvertex.png"}}};
  std::ofstream(folder / "gltf/in.gltf") << gltf;
  std::filesystem::copy(folder / "own.bin", folder / "gltf/own.bin");
  std::filesystem::copy(folder / "difference.png", folder / "gltf/per_vertex.png");
  const auto all_bytes = [&] {
    std::string bytes;
    for (const char* name : {"difference.png", "lit.ply", "report.json", "gltf/per_vertex.png", "own.bin"})
      bytes += read_bytes(folder / name) + '|';
    return bytes;
  };
  const std::string before = all_bytes();
  for (const auto& [arguments, name] :
       {std::pair{"render in.obj -o difference.png", "difference.png, which the input needs"},
        {"compare in.obj -o .", "which the input needs"},
        {"bake in.obj -o lit.ply", "lit.ply, which the input needs"},
        {"compare quad.off --lights report.json -o .", "the lights file"},
        {"render gltf/in.gltf -o gltf/per_vertex.png", "per_vertex.png, which the input needs"}}) {
    const ToolResult result = run_tool(folder, arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << result.err;
    EXPECT_NE(result.err.find("would replace"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(name), std::string::npos) << result.err;
  }
  EXPECT_EQ(all_bytes(), before);
}

TEST(CommandLine, PagesOfOthers_AreNotReplaced) {
  const ScratchFolder folder("page");
  write_quad(folder / "in.off");
  std::ofstream(folder / "index.html") << "<title>My site</title>";
  for (const char* command : {"compare in.off --size 8x8 -o .", "chart in.off --budget-seconds 0.01 -o ."}) {
    const ToolResult result = run_tool(folder, command);
    EXPECT_EQ(result.exit_code, 3) << command;
    EXPECT_NE(result.err.find("index.html"), std::string::npos) << result.err;
    EXPECT_EQ(folder.files().size(), 2U);
  }
  // What speaks of lambake is not of lambake, and what a link leads to is not beside it.
  std::filesystem::create_directories(folder / "real/deep");
  std::filesystem::create_directory(folder / "real/o");
  std::filesystem::create_directory_symlink("real/deep", folder / "link");
  std::ofstream(folder / "real/o/index.html") << "<title>Notes on lambake</title>";
  EXPECT_EQ(run_tool(folder, "compare in.off --size 8x8 -o link/../o").exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "o"));
  std::filesystem::remove(folder / "real/o/index.html");
  EXPECT_EQ(run_tool(folder, "compare in.off --size 8x8 -o link/../o").exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "real/o/index.html"));
  EXPECT_FALSE(std::filesystem::exists(folder / "o"));
  // Its own.
  EXPECT_EQ(run_tool(folder, "compare in.off --size 8x8 -o c").exit_code, 0);
  EXPECT_EQ(run_tool(folder, "compare in.off --size 8x8 -o c").exit_code, 0);
  for (const char* name : {"c", "d", "d"})
    EXPECT_EQ(run_tool(folder, std::string("chart in.off --budget-seconds 0.01 --methods face -o ") + name)
                  .exit_code,
              name[0] == 'c' ? 3 : 0);
  EXPECT_EQ(run_tool(folder, "compare in.off --size 8x8 -o d").exit_code, 3);
}

TEST(CommandLine, ClosedAndFullStreams_AreNoFaultOfOurs) {
  const ScratchFolder folder("streams");
  write_octahedron(folder / "in.off");
  const auto exit_code = [&](const std::string& arguments) {
    return run_tool(folder, "--version >/dev/null; ( '" LAMBAKE_TOOL "' " + arguments + " )").exit_code;
  };
  EXPECT_EQ(exit_code("bake in.off -o a.glb 2>&-"), 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "a.glb"));
  EXPECT_EQ(exit_code("info in.off >&- 2>&-"), 0);
  EXPECT_EQ(exit_code("info in.off --json >/dev/full"), 3);
  EXPECT_EQ(exit_code("bake --help >/dev/full"), 3);
  EXPECT_EQ(exit_code("bake in.off -o b.glb --json >/dev/full"), 3);
  EXPECT_EQ(exit_code("bake in.off -o c.glb 2>/dev/full"), 0);  // With a note: no light given.
  EXPECT_EQ(exit_code("info none.off 2>/dev/full"), 3);
  EXPECT_EQ(exit_code("bake in.off -o d.glb --none 2>/dev/full"), 2);
  EXPECT_EQ(exit_code("compare in.off -o e --fail-above max=0 2>/dev/full"), 1);
}

TEST(CommandLine, OutputsInTheWayOfEachOtherOrOfOtherFiles_AreRefused) {
  const ScratchFolder folder("in_the_way");
  write_octahedron(folder / "in.off");
  EXPECT_EQ(run_tool(folder, "bake in.off -o a.glb -o ./a.glb").exit_code, 2);
  EXPECT_EQ(run_tool(folder, "render in.off -o a.png -o a.png").exit_code, 2);
  std::filesystem::create_symlink("a.png", folder / "link.png");
  EXPECT_EQ(run_tool(folder, "render in.off -o a.png -o link.png").exit_code, 2);
  std::ofstream(folder / "a.png") << "it is there";
  EXPECT_EQ(run_tool(folder, "render in.off -o a.png -o link.png").exit_code, 2);
  std::ofstream(folder / "scan.bin") << "of something else";
  const ToolResult refused = run_tool(folder, "bake in.off -o scan.gltf");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("scan.bin"), std::string::npos) << refused.err;
  ASSERT_EQ(run_tool(folder, "compare in.off -o out --size 16x16").exit_code, 0);
  EXPECT_EQ(run_tool(folder, "compare out/lit.glb -o out --size 16x16").exit_code, 2);
  EXPECT_EQ(run_tool(folder, "compare out/lit.glb -o out2 --size 16x16").exit_code, 0);
}

TEST(CommandLine, FoldersInTheWayOfFiles_LeaveTheFolderAsItWas) {
  const ScratchFolder folder("folder_in_the_way");
  write_octahedron(folder / "in.off");
  std::filesystem::create_directories(folder / "out" / "difference.png");
  EXPECT_EQ(run_tool(folder, "compare in.off -o out --size 16x16").exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "lit.glb"));
}

TEST(CommandLine, GltfInTheWayOfItsSourcesBuffer_IsRefused) {
  const ScratchFolder folder("buffer");
  write_octahedron(folder / "in.off");
  ASSERT_EQ(run_tool(folder, "bake in.off -o a.gltf").exit_code, 0);
  std::filesystem::copy_file(folder / "a.gltf", folder / "c.gltf");  // Its buffer is a.bin, too.
  std::filesystem::remove(folder / "a.gltf");
  const ToolResult refused = run_tool(folder, "bake c.gltf -o a.gltf --quiet");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("a.bin"), std::string::npos) << refused.err;
  EXPECT_EQ(run_tool(folder, "bake c.gltf -o a.GLTF --quiet").exit_code, 2);
  EXPECT_EQ(run_tool(folder, "bake c.gltf -o b.gltf").exit_code, 0);
}

// A certificate is of the first output, and so is what it clips: another that holds more gets more.
TEST(CommandLine, LightAboveWhite_IsInAFloatPly_WhateverComesFirst) {
  const ScratchFolder folder("above_white");
  write_octahedron(folder / "in.off");
  for (const std::string method : {"sample", "adaptive", "auto"}) {
    for (const int glb_is_first : {0, 1}) {
      const std::string outputs = glb_is_first ? "-o a.glb -o a.ply" : "-o a.ply -o a.glb";
      const ToolResult result =
          run_tool(folder, "bake in.off --lamp 3,2,2,40,40,40 --tolerance 0.2 --color f32 --json --method " +
                               method + " " + outputs);
      ASSERT_EQ(result.exit_code, 0) << result.err;
      for (const nlohmann::json& output : nlohmann::json::parse(result.out)["outputs"]) {
        if (output["path"] != "a.glb") continue;
        EXPECT_GT(output["clipped_vertices"], 0) << method;
      }
      const std::string ply = read_bytes(folder / "a.ply");
      const std::size_t start = ply.find("end_header\n") + 11;
      // Position, normal and colour of each vertex.
      const std::size_t n = nlohmann::json::parse(result.out)["vertices"];
      float brightest = 0;
      for (std::size_t v = 0; v < n; ++v)
        for (std::size_t c = 6; c < 9; ++c) {
          float value;
          std::memcpy(&value, ply.data() + start + 4 * (9 * v + c), sizeof value);
          brightest = std::max(brightest, value);
        }
      EXPECT_GT(brightest, 1.5f) << method << " " << outputs;
    }
  }
}

TEST(CommandLine, GltfWithoutNormals_GetsThoseAskedFor_WithoutCopies) {
  const ScratchFolder folder("no_normals");
  write_octahedron(folder / "in.off");
  ASSERT_EQ(run_tool(folder, "bake in.off -o in.gltf --quiet").exit_code, 0);
  nlohmann::json gltf = nlohmann::json::parse(read_bytes(folder / "in.gltf"));
  nlohmann::json& primitive = gltf["meshes"][0]["primitives"][0];
  primitive["attributes"].erase("NORMAL");
  primitive["attributes"].erase("COLOR_0");
  gltf["materials"][0].erase("extensions");
  std::ofstream(folder / "in.gltf") << gltf;
  const auto vertices_of = [&](const std::string& options, bool is_flat) {
    const ToolResult result =
        run_tool(folder, "bake in.gltf --sun 1,2,3 --json -o b.gltf -o a.ply " + options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out.find("flat_primitives") != std::string::npos, is_flat) << options;
    const nlohmann::json json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["outputs"][1]["vertices"], json["vertices"]) << options;
    const nlohmann::json written = nlohmann::json::parse(read_bytes(folder / "b.gltf"));
    const std::size_t position = written["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
    EXPECT_EQ(json["outputs"][0]["vertices"], written["accessors"][position]["count"]) << options;
    return std::size_t(json["vertices"]);
  };
  EXPECT_EQ(vertices_of("", true), 24U);
  EXPECT_EQ(vertices_of("--normals angle", false), 6U);
  EXPECT_EQ(vertices_of("--normals file", true), 24U);
  EXPECT_EQ(vertices_of("--crease-angle-deg 10", false), 24U);
}

TEST(CommandLine, VerticesInNoFace_AreNotInThePicture) {
  const ScratchFolder folder("strays");
  std::ofstream(folder / "a.off") << "OFF\n4 2 0\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n3 0 1 2\n3 0 2 3\n";
  std::ofstream(folder / "b.off")
      << "OFF\n5 2 0\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n900 900 900\n3 0 1 2\n3 0 2 3\n";
  for (const char* name : {"a", "b"})
    ASSERT_EQ(run_tool(folder, std::string("render ") + name + ".off --sun 0,0,1 --size 32x32 --quiet -o " +
                                   name + ".png")
                  .exit_code,
              0);
  EXPECT_EQ(read_bytes(folder / "a.png"), read_bytes(folder / "b.png"));
}

TEST(CommandLine, OptionsOfGltf_SayNothingToPly_AndItSaysSo) {
  const ScratchFolder folder("unheeded");
  write_quad(folder / "in.off");
  const std::string options = "bake in.off --sun 0,0,1 --attribute _LIGHT --no-unlit -o a.ply";
  const std::string told = run_tool(folder, options).err;
  EXPECT_NE(told.find("--attribute says nothing to PLY"), std::string::npos) << told;
  EXPECT_NE(told.find("--no-unlit says nothing to PLY"), std::string::npos) << told;
  EXPECT_EQ(run_tool(folder, options + " -o a.glb").err.find("says nothing"), std::string::npos);
}

}  // namespace
}  // namespace lambake::test
