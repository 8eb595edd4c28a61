// Program texts: lines, index, files.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

#include "interpreter/line_parser.h"
#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

/// A file that goes away with the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& content)
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("program_test.{}.ngc", ::getpid())) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

ErrorCode code_of(const Result<std::shared_ptr<const Program>>& program) {
  REQUIRE_FALSE(program.has_value());
  return program.error().code;
}

}  // namespace

TEST_CASE("Every line of a program is found by its number", "[JOB-6]") {
  std::string text;
  for (int line = 1; line <= 1000; ++line) text += fmt::format("N{}\r\n", line);
  const auto program = Program::from_text(text, "numbers").value();
  REQUIRE(program->line_count() == 1000);
  for (std::uint32_t line = 1; line <= 1000; ++line) {
    CHECK(program->line(line) == fmt::format("N{}", line));
  }
  CHECK(program->line(1001).empty());
  CHECK(program->line(0) == "N1");
}

TEST_CASE("The last line needs no line end, and empty lines count", "[JOB-6]") {
  const auto program = Program::from_text("a\n\n\nb", "four").value();
  CHECK(program->line_count() == 4);
  CHECK(program->line(4) == "b");
  CHECK(Program::from_text("a\nb\n", "two").value()->line_count() == 2);
}

TEST_CASE("What is not a program text is refused with its reason", "[JOB-6][LNG-10]") {
  CHECK(code_of(Program::from_text("", "empty")) == ErrorCode::program_empty);
  CHECK(code_of(Program::from_text("\xEF\xBB\xBF", "only a mark")) == ErrorCode::program_empty);
  const auto binary = Program::from_text(std::string("G0 X1\nab\0c\n", 11), "binary");
  CHECK(code_of(binary) == ErrorCode::program_not_text);
  CHECK(binary.error().place->line == 2);
  const auto missing = Program::open("/nonexistent/file.ngc");
  CHECK(code_of(missing) == ErrorCode::file_not_found);
  CHECK(missing.error().to_string() ==
        "/nonexistent/file.ngc: Cannot read it: No such file or directory. [E1001]");
  CHECK(code_of(Program::open("/")) == ErrorCode::file_not_readable);
}

TEST_CASE("A file is read whole: changing it does not change the running program", "[JOB-6]") {
  const TemporaryFile file("G0 X1\nG0 X2\n");
  const auto program = Program::open(file.path()).value();
  std::ofstream(file.path(), std::ios::binary | std::ios::trunc) << "M30\n";
  CHECK(program->line_count() == 2);
  CHECK(program->line(2) == "G0 X2");
  CHECK(program->name() == file.path().string());
}

TEST_CASE("A large file that is truncated while it runs fails at the missing line",
          "[JOB-6][LNG-10]") {
  constexpr std::uint64_t kLine = 64;
  const std::string line = "G0 X1 (" + std::string(kLine - 9, '-') + ")\n";
  std::string text;
  while (text.size() <= Program::kReadWhole) text += line;
  const TemporaryFile file(text);
  const auto program = Program::open(file.path()).value();
  CHECK_FALSE(program->was_truncated());

  // In the middle of a page and of line 10001, and at the beginning of the last line.
  const std::uint64_t left = GENERATE_COPY(kLine * 10'000 + 6, text.size() - kLine);
  std::filesystem::resize_file(file.path(), left);

  config::ParameterStore parameters;
  config::ToolTable tools;
  Interpreter interpreter({}, parameters, tools);
  interpreter.start(program, {});
  Progress progress = interpreter.next();
  std::uint64_t moves = 0;
  for (; progress == Progress::command || progress == Progress::working;
       progress = interpreter.next()) {
    if (progress != Progress::command) continue;
    if (std::holds_alternative<RapidMove>(interpreter.command().body)) ++moves;
  }
  REQUIRE(progress == Progress::failed);
  CHECK(interpreter.diagnostic().code == ErrorCode::program_truncated);
  CHECK(interpreter.diagnostic().line == left / kLine + 1);
  CHECK(moves == left / kLine);
  CHECK(program->was_truncated());
}

TEST_CASE("Lines may have 4096 characters; a longer one is refused with its number",
          "[JOB-6][LNG-10]") {
  const std::string comment(kMaxLineLength - 7, 'x');
  CHECK(refusal_of("G0 X1(" + comment + ")\n").empty());
  CHECK(refusal_of("G0 X1(" + comment + "x)\n") == "line_too_long@4097");
}

TEST_CASE("Loops and subs are found in long files", "[JOB-6][LNG-3]") {
  std::string text = "gosub last\nM30\n";
  for (int line = 0; line < 100'000; ++line) text += "G0 X1 Y2 (S sub while if)\n";
  text += "N7 sub last\n#1=5\nendsub\n";
  Bench bench;
  REQUIRE_FALSE(bench.run(text).failed);
  CHECK(bench.parameters.get(1) == 5.0);
}
