#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "cli/models.h"
#include "cli/run_tool.h"

namespace lambake::test {
namespace {

TEST(CommandLine, Bake_GlbAndPly_WritesBothAndSaysSo) {
  const ScratchFolder folder("bake");
  write_octahedron(folder / "in.off");
  const ToolResult result = run_tool(folder, "bake in.off --sun 0,0,1 -o a.glb -o b.ply");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("a.glb: 6 vertices, 8 triangles"), std::string::npos) << result.out;
  EXPECT_EQ(read_bytes(folder / "a.glb").substr(0, 4), "glTF");
  EXPECT_EQ(read_bytes(folder / "b.ply").substr(0, 4), "ply\n");
}

TEST(CommandLine, Bake_Gltf_CountsTheBytesOfItsBufferToo) {
  const ScratchFolder folder("bytes");
  write_octahedron(folder / "in.off");
  const ToolResult result = run_tool(folder, "bake in.off -o a.gltf -o b.glb --json");
  const auto outputs = nlohmann::json::parse(result.out)["outputs"];
  EXPECT_EQ(outputs[0]["bytes"],
            std::filesystem::file_size(folder / "a.gltf") + std::filesystem::file_size(folder / "a.bin"));
  EXPECT_EQ(outputs[1]["bytes"], std::filesystem::file_size(folder / "b.glb"));
}

TEST(CommandLine, EveryCommand_Json_IsJsonAndNothingElse) {
  const ScratchFolder folder("json");
  write_octahedron(folder / "in.off");
  for (const char* arguments : {"bake in.off -o a.glb --json", "render in.off -o a.png --size 32x32 --json",
                                "compare in.off -o cmp --size 32x32 --json", "info in.off --json",
                                "chart in.off -o chart --budget-seconds 0.5 --json"}) {
    const ToolResult result = run_tool(folder, arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << "\n" << result.err;
    const auto json = nlohmann::json::parse(result.out, nullptr, false);
    EXPECT_TRUE(json.is_object()) << arguments << "\n" << result.out;
  }
}

TEST(CommandLine, Info_SaysWhatAMaterialAndALightAreInWords) {
  const ScratchFolder folder("words");
  const ToolResult result = run_tool(folder, "info " LAMBAKE_SOURCE_DIR "/meshes/gallery.glb");
  for (const char* line :
       {"min                    -5 0 -4\n",
        "materials              \"window\", base color 0.62 0.78 0.95, unlit\n",
        "lights                 type spot, \"spot\", intensity 7.639437 7.2574654 6.4935217\n",
        "cameras                room, knot\n"})
    EXPECT_NE(result.out.find(line), std::string::npos) << line;
}

TEST(CommandLine, NoCommandOrAnUnknownOne_IsNamedBesideThoseThatThereAre) {
  const ScratchFolder folder("unknown");
  const std::string expected = "lambake: expected a command (bake, render, compare, chart, info), found ";
  EXPECT_EQ(run_tool(folder, "").err, expected + "none (see lambake --help)\n");
  EXPECT_EQ(run_tool(folder, "bakee in.off").err, expected + "\"bakee\" (see lambake --help)\n");
  const std::string extras = "lambake: expected options, found ";
  EXPECT_EQ(run_tool(folder, "bake in.off --sunn 1,1,1 -o a.glb").err,
            extras + "--sunn 1,1,1 (see lambake bake --help)\n");
  EXPECT_NE(run_tool(folder, "bake in.off --sun 1 1 1 -o a.glb").err.find("have commas between them"),
            std::string::npos);
  EXPECT_EQ(run_tool(folder, "bakee in.off").exit_code, 2);
}

TEST(CommandLine, NamesWithLineEndsAndEscapes_AreToldOnOneLine) {
  const ScratchFolder folder("names");
  const ToolResult result = run_tool(folder, "info \"$(printf 'a\\nb\\033[1m.off')\"");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.err, "lambake: a\\x0Ab\\x1B[1m.off: expected a file, found none\n");
}

TEST(CommandLine, OptionsThatTheMethodDoesNotHeed_AreTold) {
  const ScratchFolder folder("unheeded");
  write_octahedron(folder / "in.off");
  EXPECT_EQ(
      run_tool(folder, "bake in.off --normals angle --sun 0,0,1 --levels 2 --tolerance 0.1 -o a.glb").err,
      "lambake: --tolerance says nothing to --method sample; it is for adaptive and auto\n"
      "lambake: --levels says nothing to --method sample; it is for uniform\n");
  EXPECT_EQ(
      run_tool(folder, "bake in.off --normals angle --sun 0,0,1 --method uniform --levels 2 -o a.glb").err,
      "");
  EXPECT_EQ(
      run_tool(folder,
               "bake in.off --normals angle --sun 0,0,1 --method average --light-tolerance 0 -o a.glb")
          .err,
      "lambake: --light-tolerance says nothing to --method average; it is for sample and face and uniform "
      "and auto\n");
  EXPECT_EQ(run_tool(folder, "bake in.off --normals angle --sun 0,0,1 --scene 1 -o a.glb").err,
            "lambake: --scene says nothing to OFF; it is for glTF\n");
}

TEST(CommandLine, SharpEdgesThatAreSmoothed_AreTold_UnlessThatIsAskedForOrDoesNotShow) {
  const ScratchFolder folder("smoothed");
  write_octahedron(folder / "in.off");
  const auto is_told = [&](const std::string& arguments) {
    return run_tool(folder, arguments).err.find("8 faces lean more than 40 degrees") != std::string::npos;
  };
  EXPECT_TRUE(is_told("bake in.off -o a.glb"));
  EXPECT_TRUE(is_told("render in.off -o a.png --size 8x8"));
  EXPECT_FALSE(is_told("bake in.off --crease-angle-deg 30 -o a.glb"));
  EXPECT_FALSE(is_told("bake in.off --normals angle -o a.glb"));
  EXPECT_FALSE(is_told("bake in.off --method face -o a.glb"));
  EXPECT_FALSE(is_told("render in.off --shading face -o a.png --size 8x8"));
}

TEST(CommandLine, LevelsThatNoGlbCanHold_AreRefusedBeforeTheCutting) {
  const ScratchFolder folder("levels");
  write_octahedron(folder / "in.off");
  for (const char* arguments :
       {"bake in.off --normals angle --sun 0,0,1 --method uniform --levels 13 -o a.ply -o a.glb",
        "compare in.off --normals angle --sun 0,0,1 --method uniform --levels 13 -o compared"}) {
    const ToolResult result = run_tool(folder, arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err,
              "lambake: --levels 13: expected levels that a GLB can hold, of at most 4294967295 bytes, found "
              "536870912 triangles, at least 13955891424 bytes\n");
  }
}

TEST(CommandLine, Help_EveryCommand_HasAnExampleThatRuns) {
  const ScratchFolder folder("help");
  write_octahedron(folder / "bunny.ply.off");
  for (const std::string command : {"bake", "render", "compare", "chart", "info"}) {
    const ToolResult help = run_tool(folder, command + " --help");
    EXPECT_EQ(help.exit_code, 0);
    std::smatch match;
    ASSERT_TRUE(std::regex_search(help.out, match, std::regex("Example: lambake ([^\n]*(\n +[^\n]+)*)")))
        << help.out;
    std::string example =
        std::regex_replace(match[1].str(), std::regex("bunny\\.ply(?!\\.off)"), "bunny.ply.off");
    example = std::regex_replace(example, std::regex("--budget-seconds 30"), "--budget-seconds 0.5");
    // The examples may say "differs too much": what is tested is that their options are right.
    const ToolResult result = run_tool(folder, example);
    EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 1) << example << "\n" << result.err;
  }
}

TEST(CommandLine, Usage_WrongOptions_ExitWith2AndOneLine) {
  const ScratchFolder folder("usage");
  write_quad(folder / "in.off");
  for (const char* arguments : {"",
                                "bake",
                                "bake in.off",
                                "bake in.off -o a.xyz",
                                "bake in.off -o a.glb --sun 1,2",
                                "bake in.off -o a.glb --sun 0,0,0",
                                "bake in.off -o a.glb --sun a,b,c",
                                "bake in.off -o a.glb --sun nan,0,1",
                                "bake in.off -o a.glb --lamp 1,2,3,4",
                                "bake in.off -o a.glb --lamp 1,2,3,1,1,1,-1",
                                "bake in.off -o a.glb --sun 0,0,1,-1,0,0",
                                "bake in.off -o a.glb --normals round",
                                "bake in.off -o a.glb --normals file",
                                "bake in.off -o a.glb --crease-angle-deg 200",
                                "bake in.off -o a.glb --albedo 2,0,0",
                                "bake in.off -o a.ply --color u16",
                                "bake in.off -o a.glb --exposure nan",
                                "render in.off -o a.png --size 0x10",
                                "render in.off -o a.png --size 10",
                                "render in.off -o a.jpg",
                                "render in.off -o a.png --camera left",
                                "render in.off -o a.png --eye 0,0,0 --target 0,0,0",
                                "render in.off -o a.png --target 0,0,1",
                                "compare in.off -o c --views 0",
                                "compare in.off -o c --fail-above rmse",
                                "compare in.off -o c --size 16x16 --fail-above nothing=1",
                                "compare in.off -o c --views 3 --eye 1,2,3",
                                "compare in.off -o c --fail-above rmse=x",
                                "bake in.off -o a.glb --tolerance 0",
                                "bake in.off -o a.glb --method adaptive --tolerance 3",
                                "bake in.off -o a.glb --sun 0,0,1,1e30,1e30,1e30 --exposure 64",
                                "bake in.off -o a.glb --attribute light",
                                "frobnicate in.off",
                                "bake in.off -o a.glb --no-such-option"}) {
    const ToolResult result = run_tool(folder, arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << "\n" << result.err;
    EXPECT_EQ(count_lines(result.err), 1 + (result.err.find("no light given") != std::string::npos))
        << arguments << "\n"
        << result.err;
    EXPECT_TRUE(result.out.empty()) << arguments;
  }
}

TEST(CommandLine, Input_MissingOrBroken_ExitWith3AndNothingWritten) {
  const ScratchFolder folder("input");
  std::ofstream(folder / "broken.off") << "OFF\n4 2 0\n-1 -1 0\n1 -1 0\n";
  std::ofstream(folder / "index.off") << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n";
  std::ofstream(folder / "lights.json")
      << R"({"lights": [{"type": "point", "position": [0, 0, 1], "colour": [1, 1, 1]}]})";
  write_quad(folder / "in.off");
  const std::size_t n_files = folder.files().size();
  for (const char* arguments :
       {"bake nothing.ply -o a.glb", "bake broken.off -o a.glb", "bake index.off -o a.glb",
        "bake in.off --lights lights.json -o a.glb", "bake in.off --lights nothing.json -o a.glb",
        "render broken.off -o a.png", "compare index.off -o c", "info broken.off", "bake . -o a.glb",
        "bake in.off -o no/such/folder/a.glb"}) {
    const ToolResult result = run_tool(folder, std::string(arguments) + " --quiet");
    const bool is_info = std::string(arguments).starts_with("info");
    const ToolResult& checked = is_info ? run_tool(folder, arguments) : result;
    EXPECT_EQ(checked.exit_code, 3) << arguments << "\n" << checked.err;
    EXPECT_EQ(count_lines(checked.err), 1U) << arguments << "\n" << checked.err;
    EXPECT_EQ(folder.files().size(), n_files) << arguments;
  }
  EXPECT_NE(run_tool(folder, "bake in.off --lights lights.json -o a.glb").err.find("colour"),
            std::string::npos);
}

TEST(CommandLine, OptionsThatAreWrongWhateverTheFile_AreToldBeforeItIsRead) {
  const ScratchFolder folder("before");
  for (const char* arguments :
       {"render none.ply -o a.png --target 0,0,0", "render none.ply -o a.png --fov-deg 50",
        "render none.ply -o a.png --camera 1 --eye 1,2,3", "compare none.ply -o c --eye 0,1",
        "compare none.ply -o c --views 3 --eye 1,2,3", "compare none.ply -o c --eye 1,2,3 --fov-deg 180",
        "chart none.ply -o c --eye 1,2", "render none.ply -o a.png --up x",
        "render none.ply -o a.png --up z --camera 0", "bake none.ply -o a.glb --sun 1,2",
        "bake none.ply -o a.glb --lamp 1,2,3,4", "bake none.ply -o a.glb --albedo 2,0,0",
        "bake none.ply -o a.glb --exposure 65", "bake none.ply -o a.glb --crease-angle-deg 200",
        "bake none.ply -o a.glb --crease-angle-deg 30 --normals file"}) {
    const ToolResult result = run_tool(folder, arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << "\n" << result.err;
    EXPECT_EQ(count_lines(result.err), 1U) << result.err;
  }
}

// The sun that is taken where there is no light turns with the model.
TEST(CommandLine, ZUp_TurnsTheDefaultSun) {
  const ScratchFolder folder("sun_up");
  std::ofstream(folder / "y.off") << "OFF\n4 2 0\n-1 0 2\n1 0 2\n1 0.5 -1\n-1 1 -1\n3 0 1 2\n3 0 2 3\n";
  std::ofstream(folder / "z.off") << "OFF\n4 2 0\n-1 -2 0\n1 -2 0\n1 1 0.5\n-1 1 1\n3 0 1 2\n3 0 2 3\n";
  run_tool(folder, "render y.off --size 32x32 -o y.png");
  EXPECT_NE(run_tool(folder, "render z.off --up z --size 32x32 -o z.png").err.find("0.4,-0.3,1"),
            std::string::npos);
  EXPECT_EQ(read_bytes(folder / "y.png"), read_bytes(folder / "z.png"));
}

// What baking notices is told by pictures of it as well.
TEST(CommandLine, RenderPerVertex_TellsWhatBakingNotices) {
  const ScratchFolder folder("render_findings");
  write_octahedron(folder / "in.off");
  const ToolResult rendered =
      run_tool(folder, "render in.off --lamp 1,0,0 --shading vertex --size 16x16 -o a.png --json");
  EXPECT_NE(rendered.err.find("on a lamp"), std::string::npos) << rendered.err;
  EXPECT_NE(rendered.out.find("points_on_a_lamp"), std::string::npos) << rendered.out;
}

TEST(CommandLine, ZUp_ShowsATurnedModelAsYUpShowsIt) {
  const ScratchFolder folder("up");
  std::ofstream(folder / "y.off") << "OFF\n4 2 0\n-1 0 2\n1 0 2\n1 0.5 -1\n-1 1 -1\n3 0 1 2\n3 0 2 3\n";
  std::ofstream(folder / "z.off") << "OFF\n4 2 0\n-1 -2 0\n1 -2 0\n1 1 0.5\n-1 1 1\n3 0 1 2\n3 0 2 3\n";
  const std::string rest = " --size 64x64 --quiet -o ";
  EXPECT_EQ(run_tool(folder, "render y.off --sun 0,3,4" + rest + "y.png").exit_code, 0);
  EXPECT_EQ(run_tool(folder, "render z.off --sun 0,-4,3 --up z" + rest + "z.png").exit_code, 0);
  EXPECT_EQ(run_tool(folder, "render z.off --sun 0,-4,3" + rest + "lying.png").exit_code, 0);
  EXPECT_EQ(read_bytes(folder / "y.png"), read_bytes(folder / "z.png"));
  EXPECT_NE(read_bytes(folder / "z.png"), read_bytes(folder / "lying.png"));
}

TEST(CommandLine, Render_TellsWhatAScreenDoesNotShow) {
  const ScratchFolder folder("brightness");
  write_quad(folder / "in.off");
  const auto told = [&](const std::string& arguments) {
    return run_tool(folder, "render in.off --eye 0,0,3 --size 16x16 " + arguments).err;
  };
  // Of 5, three stops lower is 0.625.
  const std::string bright = told("--sun 0,0,1,5,1,1 -o a.png");
  EXPECT_NE(bright.find("brighter than white (an exposure lower by 3 stops shows"), std::string::npos)
      << bright;
  EXPECT_EQ(told("--sun 0,0,1,5,1,1 -o a.exr"), "");
  EXPECT_EQ(told("--sun 0,0,1,5,1,1 --exposure -3 -o a.png"), "");
  EXPECT_NE(told("--sun 0,0,1,1e-5,0,0 -o a.png").find("too dark to be seen"), std::string::npos);
  EXPECT_NE(told("--sun 0,0,-1 -o a.png").find("the lights are behind the surface"), std::string::npos);
  EXPECT_NE(told("--sun 0,0,1 --albedo 0,0,0 -o a.png").find("black, as the base colour is"),
            std::string::npos);
}

TEST(CommandLine, MaterialsThatBlend_AreToldByWhatDrawsThem) {
  const ScratchFolder folder("blend");
  const auto is_told = [&](const std::string& command) {
    const ToolResult result = run_tool(folder, command + " --size 16x16 --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const nlohmann::json json = nlohmann::json::parse(result.out);
    for (const auto& finding : json["findings"])
      if (finding["code"] == "drawn_opaque") return finding["count"] == 1;
    return false;
  };
  for (const char* mode : {"BLEND", "OPAQUE"}) {
    write_triangle_gltf(folder / "in.gltf", std::string(R"({"alphaMode": ")") + mode + "\"}");
    EXPECT_EQ(is_told("render in.gltf -o a.png"), mode == std::string("BLEND"));
    EXPECT_EQ(is_told("compare in.gltf -o c"), mode == std::string("BLEND"));
  }
}

// As a GLB leaves such a material as it is.
TEST(CommandLine, Albedo_LeavesUnlitMaterialsAlone_InEveryOutput) {
  const ScratchFolder folder("albedo");
  for (const bool is_unlit : {true, false}) {
    write_triangle_gltf(folder / "in.gltf",
                        is_unlit ? R"({"extensions": {"KHR_materials_unlit": {}}})" : "{}");
    ASSERT_EQ(run_tool(folder, "bake in.gltf --sun 0,0,1 --albedo 0,0,0 -o a.ply --quiet").exit_code, 0);
    EXPECT_EQ(read_bytes(folder / "a.ply").find("\xff\xff\xff\xff") != std::string::npos, is_unlit);
  }
}

TEST(CommandLine, FileThatCannotHoldWhatIsCertified_IsNotCertifiedByAnyCommand) {
  const ScratchFolder folder("gaps");
  std::filesystem::copy(LAMBAKE_SOURCE_DIR "/tests/io/grey188.jpg", folder / "grey.jpg");
  std::ofstream(folder / "in.mtl") << "newmtl grey\nmap_Kd grey.jpg\n";
  std::ofstream(folder / "in.obj") << "mtllib in.mtl\nusemtl grey\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 -1 0\n"
                                      "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"
                                      "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 1/1 4/4 2/2\n";
  const ToolResult plain = run_tool(folder, "bake in.obj --method adaptive -o a.ply");
  EXPECT_EQ(plain.exit_code, 0);
  EXPECT_NE(plain.out.find("not certified: no bound"), std::string::npos) << plain.out;
  EXPECT_NE(plain.err.find("1 material has a texture"), std::string::npos) << plain.err;
  const auto of = [&](const std::string& arguments) {
    return nlohmann::json::parse(run_tool(folder, "bake in.obj --json --method " + arguments).out);
  };
  const auto adaptive = of("adaptive -o a.ply");
  EXPECT_EQ(adaptive["certificate"]["certified"], false);
  EXPECT_TRUE(adaptive["certificate"]["max_bound"].is_null());
  EXPECT_EQ(adaptive["findings"].back()["code"], "certificate_not_of_file");
  const auto chosen = of("auto -o a.ply");
  EXPECT_EQ(chosen["auto"]["certified"], false);
  EXPECT_EQ(chosen["auto"]["trials"].size(), 4U);
  EXPECT_EQ(chosen["findings"], adaptive["findings"]);
  // The same light in a GLB is certified.
  EXPECT_EQ(of("adaptive -o a.glb")["certificate"]["certified"], true);
  EXPECT_EQ(of("auto -o a.glb")["auto"]["certified"], true);

  // A bound that is not there is above any threshold. What lit.glb cannot hold here is emission.
  const std::string palm = LAMBAKE_SOURCE_DIR "/../shared/meshes/gltf/PalmTree/PalmTree.gltf";
  const std::string compare = "compare " + palm + " -o c --size 16x16 --fail-above surface.display.";
  const ToolResult bounded = run_tool(folder, compare + "max_bound=1");
  EXPECT_EQ(bounded.exit_code, 1) << bounded.err;
  EXPECT_NE(bounded.out.find("none certified"), std::string::npos) << bounded.out;
  EXPECT_EQ(run_tool(folder, compare + "max_sampled=1").exit_code, 0);
  const auto report = nlohmann::json::parse(read_bytes(folder / "c/report.json"));
  std::size_t n_told = 0;
  for (const auto& finding : report["findings"]) n_told += finding["code"] == "certificate_not_of_file";
  EXPECT_EQ(n_told, 1U);
}

TEST(CommandLine, NumbersOutOfRange_AreToldByTheirOption) {
  const ScratchFolder folder("numbers");
  write_octahedron(folder / "in.off");
  for (const char* arguments :
       {"chart in.off -o c --budget-seconds 0", "bake in.off -o a.glb --max-seconds -1",
        "bake in.off -o a.glb --gradient-weight nan",
        "render in.off --normals angle -o a.png --eye 0,0,3 --fov-deg 180"}) {
    const ToolResult refused = run_tool(folder, arguments);
    EXPECT_EQ(refused.exit_code, 2) << arguments;
    EXPECT_LT(refused.err.size(), 200U) << refused.err;
    EXPECT_NE(refused.err.find("--"), std::string::npos) << refused.err;
  }
  EXPECT_NE(run_tool(folder, "render in.off --camera a --eye 0,0,3 -o a.png").err.find("no --eye"),
            std::string::npos);
}

TEST(CommandLine, CertificateOfTheFirstOutput_IsNotThatOfAnotherFormat) {
  const ScratchFolder folder("two_formats");
  write_octahedron(folder / "in.off");
  const std::string bake = "bake in.off --sun 0.3,0.2,1 --method adaptive --json ";
  EXPECT_NE(run_tool(folder, bake + "-o a.glb -o a.ply").out.find("certificate_of_another_file"),
            std::string::npos);
  EXPECT_EQ(run_tool(folder, bake + "-o a.glb -o b.glb").out.find("certificate_of_another_file"),
            std::string::npos);
  // What auto says is of the first as well, whichever method it takes.
  const std::string choose = "bake in.off --sun 0,0,1 --method auto --tolerance 0.9 --json ";
  EXPECT_NE(run_tool(folder, choose + "-o a.glb -o a.ply").out.find("certificate_of_another_file"),
            std::string::npos);
}

TEST(CommandLine, WhereNothingIsLit_ItSaysSo) {
  const ScratchFolder folder("dark");
  write_octahedron(folder / "in.off");
  std::ofstream(folder / "none.json") << "{\"lights\": []}";
  EXPECT_NE(run_tool(folder, "bake in.off --lights none.json -o a.glb").err.find("no light at all"),
            std::string::npos);
  EXPECT_NE(run_tool(folder, "bake a.glb -o b.glb").err.find("every material is unlit"), std::string::npos);
  EXPECT_NE(run_tool(folder, "bake in.off --lamp 0,0,0 -o a.glb").err.find("vertices are all black"),
            std::string::npos);
  EXPECT_NE(run_tool(folder, "bake in.off --lamp 0,0,1000 -o a.glb").err.find("the brightest has 1e-06"),
            std::string::npos);
  EXPECT_EQ(run_tool(folder, "bake in.off --lamp 0,0,1000 --exposure 16 -o a.glb").err.find("dark"),
            std::string::npos);
  EXPECT_EQ(run_tool(folder, "compare in.off -o ''").exit_code, 2);
}

TEST(CommandLine, BrightSunOnADarkSurface_ColourBelow1_IsNotClipped) {
  const ScratchFolder folder("albedo");
  write_quad(folder / "in.off");
  const ToolResult result = run_tool(folder,
                                     "compare in.off -o c --albedo 0.5,0.4,0.3 --sun 0,0,1,1.6,1.6,1.6 "
                                     "--size 64x64 --fail-above max=0.0001");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

TEST(CommandLine, OneAndTwoThreads_SameBytes) {
  const ScratchFolder folder("threads");
  const std::string bunny = "'" LAMBAKE_SOURCE_DIR "/../shared/meshes/scan/lion-head.off'";
  for (const char* n : {"1", "2"}) {
    const std::string arguments =
        bunny + " --lamp 50,300,0,9000,6000,3000 --sun 0.4,1,0.3 --quiet --threads " + n;
    ASSERT_EQ(run_tool(folder, "bake " + arguments + " -o " + n + ".glb -o " + n + ".ply").exit_code, 0);
    ASSERT_EQ(run_tool(folder, "compare " + arguments + " --size 200x150 -o c" + n).exit_code, 0);
  }
  for (const char* name : {".glb", ".ply"})
    EXPECT_EQ(read_bytes(folder / (std::string("1") + name)), read_bytes(folder / (std::string("2") + name)))
        << name;
  for (const char* name : {"per_vertex.png", "per_fragment.exr", "difference.png", "lit.glb"})
    EXPECT_EQ(read_bytes(folder / (std::string("c1/") + name)),
              read_bytes(folder / (std::string("c2/") + name)))
        << name;
  const auto numbers = [&](const char* path) {
    auto report = nlohmann::json::parse(read_bytes(folder / path));
    report.erase("seconds");
    report.erase("command");
    return report;
  };
  EXPECT_EQ(numbers("c1/report.json"), numbers("c2/report.json"));
}

TEST(CommandLine, NoLight_DefaultSun_IsSaid) {
  const ScratchFolder folder("default");
  write_quad(folder / "in.off");
  const ToolResult result = run_tool(folder, "bake in.off -o a.glb");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("one white sun from 0.4,1,0.3"), std::string::npos) << result.err;
}

TEST(CommandLine, LightAbove1_ClippedVertices_AreTold) {
  const ScratchFolder folder("clip");
  write_quad(folder / "in.off");
  const ToolResult result = run_tool(folder, "bake in.off --sun 0,0,1,3,3,3 -o a.glb");
  EXPECT_NE(result.err.find("4 vertices are brighter than"), std::string::npos) << result.err;
  EXPECT_EQ(run_tool(folder, "bake in.off --sun 0,0,1,3,3,3 --exposure -2 -o a.glb").err, "");
}

}  // namespace
}  // namespace lambake::test
