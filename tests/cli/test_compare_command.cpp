#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/models.h"
#include "cli/run_tool.h"

namespace lambake::test {
namespace {

TEST(CommandLine, Compare_Thresholds_DecideTheExitCode) {
  const ScratchFolder folder("threshold");
  write_octahedron(folder / "in.off");
  const std::string compare = "compare in.off -o c --sun 0.3,0.2,1 --size 64x64 --quiet ";
  EXPECT_EQ(run_tool(folder, compare + "--fail-above rmse=1").exit_code, 0);
  const ToolResult failed =
      run_tool(folder, compare + "--fail-above rmse=0.001 --fail-above surface.linear.rmse=0.9");
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_NE(failed.err.find("image.display.rmse"), std::string::npos) << failed.err;
  EXPECT_EQ(count_lines(failed.err), 1U) << failed.err;
  // Numbers that only some reports have, and such beside the picture's.
  for (const char* metric : {"surface.display.max_bound=0.001", "worst.0.error=0.001", "vertices=5"})
    EXPECT_EQ(run_tool(folder, compare + "--fail-above " + metric).exit_code, 1) << metric;
  EXPECT_EQ(run_tool(folder, compare + "--method face --fail-above mean=0.00001").exit_code, 1);
  for (const char* metric :
       {"nonsense=1", "a~b=1", "worst.99999999999999999999.error=1", "worst.0junk.error=1", "surface=1",
        "image.display.=1", "max_at=1", "psnr_db=30", "image.linear.psnr_db=30"})
    EXPECT_EQ(run_tool(folder, compare + "--fail-above " + metric).exit_code, 2) << metric;
  EXPECT_EQ(run_tool(folder, compare + "--method adaptive --fail-above error_shares.clipping=0.5").exit_code,
            0);
}

TEST(CommandLine, PictureThatShowsNothing_IsTold_AndHasNoErrorToPass) {
  const ScratchFolder folder("nothing");
  write_octahedron(folder / "in.off");
  const std::string away = " in.off --eye 0,0,50 --target 0,0,100 --size 16x16 ";
  const ToolResult compared = run_tool(folder, "compare" + away + "-o out --fail-above rmse=0.5");
  EXPECT_EQ(compared.exit_code, 1);
  EXPECT_NE(compared.err.find("shows nothing"), std::string::npos) << compared.err;
  EXPECT_NE(compared.out.find("picture   shows nothing"), std::string::npos) << compared.out;
  const auto report = nlohmann::json::parse(read_bytes(folder / "out/report.json"));
  EXPECT_TRUE(report["image"]["display"]["rmse"].is_null());
  EXPECT_TRUE(report["image"]["linear"]["max"].is_null());
  EXPECT_EQ(run_tool(folder, "compare" + away + "-o out --fail-above surface.display.max=1").exit_code, 2);
  EXPECT_EQ(
      run_tool(folder, "compare" + away + "-o out --fail-above surface.display.max_sampled=1").exit_code, 0);
  EXPECT_NE(run_tool(folder, "render" + away + "-o a.png").err.find("shows nothing"), std::string::npos);
}

std::string headline(const std::string& page) {
  const std::size_t begin = page.find("<h1>") + 4;
  return page.substr(begin, page.find("</h1>") - begin);
}

// Emission beside a texture has no place in an unlit GLB: what is compared is what it shows.
TEST(CommandLine, Compare_EmissionThatTheGlbLoses_IsPartOfTheDifference) {
  const ScratchFolder folder("lost_emission");
  const std::string palm = LAMBAKE_SOURCE_DIR "/../shared/meshes/gltf/PalmTree/PalmTree.gltf";
  for (const std::string method : {"sample", "auto"}) {
    const ToolResult compared =
        run_tool(folder, "compare " + palm + " -o c --size 64x64 --fail-above rmse=0.1 --method " + method);
    EXPECT_EQ(compared.exit_code, 1) << compared.err;
    ASSERT_EQ(run_tool(folder, "render c/lit.glb --shading vertex --size 64x64 -o again.png").exit_code, 0);
    EXPECT_EQ(read_bytes(folder / "c/per_vertex.png"), read_bytes(folder / "again.png"));
  }
  run_tool(folder, "compare " + palm + " -o c --size 64x64");
  const std::string told = headline(read_bytes(folder / "c/index.html"));
  EXPECT_NE(told.find("most of it is light that materials emit"), std::string::npos) << told;
}

// Linear values above 1 that a screen shows as white on both sides are no difference on it.
TEST(CommandLine, Compare_BlamesClipping_OnlyWhereItShows) {
  const ScratchFolder folder("clipping");
  std::ofstream(folder / "in.obj")
      << "mtllib in.mtl\nv 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
         "v 2 0 0\nv 5 0 0\nv 5 3 0\nv 2 3 0\nusemtl round\n"
         "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n"
         "usemtl flat\nf 7 8 9 10\n";
  for (const bool is_dark : {true, false}) {
    std::ofstream(folder / "in.mtl") << "newmtl flat\nKd 1 1 1\nnewmtl round\nKd "
                                     << (is_dark ? "0.2 0.2 0.2" : "1 1 1") << "\n";
    run_tool(folder, "compare in.obj -o c --size 64x64 --sun 0,0,1,8,8,8");
    const std::string told = headline(read_bytes(folder / "c/index.html"));
    EXPECT_NE(told.find("is visible"), std::string::npos) << told;
    EXPECT_EQ(told.find("brighter than white") != std::string::npos, !is_dark) << told;
  }
}

TEST(CommandLine, Thresholds_TakeQuotients_ButNoStepsOf255) {
  const ScratchFolder folder("steps");
  write_octahedron(folder / "in.off");
  const std::string compare = "compare in.off --sun 0.3,0.2,1 -o out --size 16x16 --fail-above rmse=";
  EXPECT_EQ(run_tool(folder, compare + "254/255").exit_code, 0);
  EXPECT_EQ(run_tool(folder, compare + "0/255").exit_code, 1);
  EXPECT_EQ(run_tool(folder, compare + "1/0").exit_code, 2);
  const ToolResult refused = run_tool(folder, compare + "3");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("3/255"), std::string::npos) << refused.err;
}

TEST(CommandLine, Compare_Folder_HoldsAllThatIsPromised) {
  const ScratchFolder folder("folder");
  write_octahedron(folder / "in.off");
  ASSERT_EQ(run_tool(folder, "compare in.off -o out --sun 0.3,0.2,1 --size 64x64 --views 3").exit_code, 0);
  std::vector<std::string> files = folder.files();
  std::sort(files.begin(), files.end());
  EXPECT_EQ(files, (std::vector<std::string>{"difference.png", "in.off", "index.html", "lit.glb", "lit.ply",
                                             "per_fragment.exr", "per_fragment.png", "per_vertex.exr",
                                             "per_vertex.png", "report.json", "surface_error.ply"}));
  const auto report = nlohmann::json::parse(read_bytes(folder / "out/report.json"));
  for (const char* space : {"linear", "display"}) {
    for (const char* key : {"rmse", "mae", "max", "psnr_db", "p99", "pixels", "pixels_over_1_255"})
      EXPECT_TRUE(report["image"][space].contains(key)) << space << " " << key;
    for (const char* key : {"rmse", "mae", "max_sampled", "area"})
      EXPECT_TRUE(report["surface"][space].contains(key)) << space << " " << key;
  }
  EXPECT_GT(report["image"]["display"]["rmse"].get<double>(), 0.01);
}

TEST(CommandLine, Compare_NothingToWriteInTheMiddle_LeavesNoFolder) {
  const ScratchFolder folder("nan");
  std::ofstream(folder / "in.obj") << "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(run_tool(folder, "compare in.obj -o out --size 16x16").exit_code, 4);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(CommandLine, FlatFaceUnderASun_Compare_DifferenceIsExactly0) {
  const ScratchFolder folder("flat");
  write_quad(folder / "in.off");
  const ToolResult result = run_tool(
      folder, "compare in.off -o c --sun 0.3,0.2,1 --size 64x64 --color f32 --json --fail-above max=0");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

}  // namespace
}  // namespace lambake::test
