// Macro files that other people wrote: each is loaded as the machine would load it, and every sub
// in it is called once, rendered and run. Skipped where the corpus is not at hand.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cctype>
#include <filesystem>
#include <sstream>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

const std::string kMacros = std::string(CNC_SOURCE_DIR) + "/../shared/corpus/macros/";

bool corpus_missing() {
  if (std::filesystem::exists(kMacros)) return false;
  WARN("The corpus of real macro files is not here: test skipped.");
  return true;
}

/// A machine whose user has such a file.
struct File {
  const char* name;
  std::size_t subs;
  const char* set_up;      ///< parameters that its user has set
  const char* companions;  ///< subs that it calls and another of its user's files has
};

constexpr const char* kToolSetter = "#4996=50 #4997=1 #4998=1 #4999=-60 #5016=1 #5018=6 #5025=1";
constexpr auto kFiles = std::to_array<File>({
    {"Miniclubbin--EDING_DEFAULT_macro.cnc", 50, kToolSetter, ""},
    {"Miniclubbin--user_macro.cnc", 35, "",
     "MOVE_Machine0 WCS_0 Z_PROBE TOOL_MEASURE TOOL_CHANGE_DLG TOOL_NBR_UPDATE MOVE_WCS0_G54 "
     "MOVE_WCS0_G55 MOVE_WCS0_G56 MOVE_WCS0_G57 RAISE_Z CFG_TOOLRACK 3D_menu PROBE_CUTOUT LOWER_Z "
     "WCS0_Z5 spinogy_warmup spinogy_greaserun TCP TLO"},
    {"Schallbert--macro.cnc", 33, "#185=1", ""},
    {"kgerrits--macro.cnc", 48, kToolSetter,
     "tool_minus_one tool_plus_one cycle_facing_parameters cycle_OD_turning_parameters "
     "cycle_OD_turning_chamfer_parameters cycle_ID_turning_parameters cycle_drilling_parameters "
     "cycle_external_threading_parameters cycle_internal_threading_parameters "
     "cycle_parting_off_parameters cycle_groove_turning_parameters set_default_cycle_parameters"},
    {"kochsystems--kreis_innen_mittelpunkt.cnc", 1, "", ""},
    // Feeds, ways and the diameter of its 3D probe.
    {"kochsystems--macro.cnc", 14,
     "#4009=100 #4010=50 #4011=500 #4012=500 #4013=5 #4014=5 #4015=20 #4016=9 #4017=4", ""},
    {"plylab-nl--macro.cnc", 13, "#5011=1", ""},
    // The second of its spindles.
    {"spinogy--english_macro.cnc", 3, "#4337=1 #4338=6 #4339=30000", ""},
});

/// A sub that does not come to its end, and why.
struct Exception {
  const char* file;
  const char* sub;
  RunMode mode;
  ErrorCode code;
  const char* why;
};

constexpr RunMode kRun = RunMode::run;
constexpr RunMode kRender = RunMode::render;
constexpr auto kExceptions = std::to_array<Exception>({
    {"Miniclubbin--EDING_DEFAULT_macro.cnc", "measure_used_tools", kRun,
     ErrorCode::unknown_statement, "GetToolInfo of 4.03"},
    {"Miniclubbin--EDING_DEFAULT_macro.cnc", "measure_used_tools", kRender,
     ErrorCode::unknown_statement, "GetToolInfo of 4.03"},
    {"Miniclubbin--EDING_DEFAULT_macro.cnc", "user_4", kRun, ErrorCode::unknown_statement,
     "GetToolInfo of 4.03"},
    {"Miniclubbin--EDING_DEFAULT_macro.cnc", "user_4", kRender, ErrorCode::unknown_statement,
     "GetToolInfo of 4.03"},
    {"Schallbert--macro.cnc", "user_2", kRun, ErrorCode::program_raised_error,
     "errmsg: its dialog was given no tool length"},
    {"Schallbert--macro.cnc", "xhc_macro_2", kRun, ErrorCode::program_raised_error,
     "errmsg: its dialog was given no tool length"},
    {"Schallbert--macro.cnc", "zhcmgrid", kRun, ErrorCode::sub_duplicate,
     "the file has two of that name"},
    {"Schallbert--macro.cnc", "zhcmgrid", kRender, ErrorCode::sub_duplicate,
     "the file has two of that name"},
    {"kgerrits--macro.cnc", "measure_used_tools", kRun, ErrorCode::unknown_statement,
     "GetToolInfo of 4.03"},
    {"kgerrits--macro.cnc", "measure_used_tools", kRender, ErrorCode::unknown_statement,
     "GetToolInfo of 4.03"},
    {"kgerrits--macro.cnc", "reset_alarm_toolchanger", kRun, ErrorCode::unknown_statement,
     "modbus of 4.03"},
    {"kgerrits--macro.cnc", "reset_alarm_toolchanger", kRender, ErrorCode::unknown_statement,
     "modbus of 4.03"},
    {"kgerrits--macro.cnc", "home_toolchanger", kRun, ErrorCode::unknown_statement,
     "modbus of 4.03"},
    {"kgerrits--macro.cnc", "home_all", kRun, ErrorCode::unknown_statement, "modbus of 4.03"},
    {"kgerrits--macro.cnc", "change_tool", kRun, ErrorCode::unknown_statement, "modbus of 4.03"},
    {"plylab-nl--macro.cnc", "m_tool", kRun, ErrorCode::program_raised_error,
     "errmsg: its caller gives it the tool"},
});

/// Names of the subs of a macro file, in their order.
std::vector<std::string> subs_of(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword;
    std::string name;
    words >> keyword >> name;
    for (char& c : keyword) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (keyword == "sub") names.push_back(name);
  }
  return names;
}

}  // namespace

namespace {

Outcome call(const File& file, const std::string& macros, const std::string& sub, RunMode mode) {
  Bench bench;
  bench.mode = mode;
  bench.tool_in_spindle = 1;
  bench.settings.machine.positive_limit[Axis::Z] = 100;
  REQUIRE(bench.tools.set(1, {.length = 30, .diameter = 6, .description = {}}));
  bench.add_macros(macros);
  std::string companions;
  std::istringstream names(file.companions);
  for (std::string name; names >> name;) companions += "sub " + name + "\nendsub\n";
  if (!companions.empty()) bench.add_macros(companions, "companions.cnc");
  return bench.run(std::string(file.set_up) + "\nF100\ngosub " + sub + "\nM30\n");
}

const Exception* exception_for(const File& file, const std::string& sub, RunMode mode) {
  const auto row = std::find_if(kExceptions.begin(), kExceptions.end(), [&](const Exception& e) {
    return e.file == std::string_view(file.name) && e.sub == sub && e.mode == mode;
  });
  return row == kExceptions.end() ? nullptr : &*row;
}

}  // namespace

TEST_CASE("Every sub of real macro files ends as its row says", "[LNG-6][LNG-8]") {
  if (corpus_missing()) return;
  const File file = GENERATE(from_range(kFiles));
  const RunMode mode = GENERATE(kRun, kRender);
  const std::string macros = read_file(kMacros + file.name);
  const std::vector<std::string> subs = subs_of(macros);
  CHECK(subs.size() == file.subs);
  for (const std::string& sub : subs) {
    INFO(file.name << ", " << sub << (mode == kRun ? ", run" : ", rendered"));
    const Outcome outcome = call(file, macros, sub, mode);
    CHECK(outcome.library_warnings.empty());
    if (const Exception* exception = exception_for(file, sub, mode)) {
      INFO(exception->why);
      CHECK(outcome.diagnostic.code == exception->code);
    } else {
      CHECK(refusal_of(outcome).empty());
      if (outcome.failed) UNSCOPED_INFO(outcome.diagnostic.to_string());
      REQUIRE_FALSE(outcome.lines.empty());
      CHECK(outcome.lines.back() == "PROGRAM_END()");
    }
  }
}

TEST_CASE("Every macro file of the corpus has a row", "[LNG-6]") {
  if (corpus_missing()) return;
  for (const auto& entry : std::filesystem::directory_iterator(kMacros)) {
    const std::string name = entry.path().filename().string();
    INFO(name);
    const bool is_program = name == "kgerrits--parting_off.cnc";  // it has no sub
    const bool has_row = std::any_of(kFiles.begin(), kFiles.end(),
                                     [&](const File& file) { return file.name == name; });
    CHECK(has_row != is_program);
  }
}

TEST_CASE("A turning cycle with a dialog runs as a program", "[LNG-4][GCO-7]") {
  if (corpus_missing()) return;
  const RunMode mode = GENERATE(kRun, kRender);
  Bench bench;
  bench.mode = mode;
  const Outcome outcome = bench.run(read_file(kMacros + "kgerrits--parting_off.cnc"));
  INFO(outcome.diagnostic.to_string());
  CHECK_FALSE(outcome.failed);
}
