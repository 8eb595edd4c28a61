// Program texts: lines, index, files.
#include <catch2/catch.hpp>
#include <filesystem>
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
              ("program_test." + std::to_string(::getpid()) + ".ngc")) {
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
  for (int line = 1; line <= 1000; ++line) text += "N" + std::to_string(line) + "\r\n";
  const auto program = Program::from_text(text, "numbers").value();
  REQUIRE(program->line_count() == 1000);
  for (std::uint32_t line = 1; line <= 1000; ++line) {
    CHECK(program->line(line) == "N" + std::to_string(line));
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
  CHECK(code_of(Program::open("/nonexistent/file.ngc")) == ErrorCode::file_not_found);
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
