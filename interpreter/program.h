// The text of a program: a file or a string, with an index that finds any line quickly.
//
// Up to kReadWhole bytes a file is copied into memory: it may then be edited or deleted while it
// runs. A larger one is mapped; whoever changes it in place while it runs changes what is executed.
// Whoever truncates it makes the program fail at the first line that is missing (mapped_file.h).
//
// The index holds the place of every 64th line (100 million lines: 13 MB) and the lines that steer
// the program. Immutable, so any number of threads may read it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "config/error.h"
#include "interpreter/flow_index.h"
#include "interpreter/mapped_file.h"
#include "interpreter/nesting.h"

namespace cnc::interp {

class Program {
 public:
  static constexpr std::uint64_t kReadWhole = 64ULL << 20;
  static constexpr std::uint64_t kMaxBytes = 16ULL << 30;

  /// Refuses a file that is empty, holds NUL bytes (not a text), or is larger than kMaxBytes.
  [[nodiscard]] static Result<std::shared_ptr<const Program>> open(
      const std::filesystem::path& path);
  /// The same for a text in memory; `name` stands for the file in diagnostics.
  [[nodiscard]] static Result<std::shared_ptr<const Program>> from_text(std::string text,
                                                                        std::string name);
  ~Program() = default;
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t size() const { return text_.size(); }
  [[nodiscard]] std::uint32_t line_count() const { return line_count_; }
  /// Line `number` from 1 without its line end; empty behind the last one.
  [[nodiscard]] std::string_view line(std::uint32_t number) const;

  /// A place between lines, to read on from.
  struct Cursor {
    std::uint32_t line = 1;
    std::uint64_t offset = 0;
  };
  [[nodiscard]] Cursor begin_of(std::uint32_t line) const;
  [[nodiscard]] bool at_end(const Cursor& cursor) const { return cursor.offset >= text_.size(); }
  /// The line at `cursor`, which moves to the next one.
  [[nodiscard]] std::string_view read(Cursor& cursor) const;
  /// The file has become shorter since it was opened: what is missing reads as NUL characters.
  [[nodiscard]] bool was_truncated() const { return text_.back() == '\0'; }

  [[nodiscard]] const FlowIndex& flow() const { return flow_; }
  [[nodiscard]] const NestingData& nesting() const { return nesting_; }

 private:
  explicit Program(std::string name) : name_(std::move(name)) {}

  [[nodiscard]] static Result<std::shared_ptr<const Program>> finish(
      std::shared_ptr<Program> program);
  [[nodiscard]] Result<void> index();

  static constexpr std::uint32_t kLinesPerEntry = 64;

  std::string name_;
  std::string owned_;                          ///< of a small file or a string
  std::unique_ptr<const MappedFile> mapping_;  ///< of a large file
  std::string_view text_;
  std::vector<std::uint64_t> offsets_;  ///< of lines 1, 65, 129 …
  std::uint32_t line_count_ = 0;
  FlowIndex flow_;
  NestingData nesting_;
};

}  // namespace cnc::interp
