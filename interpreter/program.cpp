#include "interpreter/program.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <limits>
#include <sys/stat.h>
#include <unistd.h>

namespace cnc::interp {
namespace {

/// An open file descriptor.
class File {
 public:
  explicit File(const std::filesystem::path& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

[[nodiscard]] std::unexpected<Error> cannot_read(const std::string& name, int error) {
  const ErrorCode code = error == ENOENT ? ErrorCode::file_not_found : ErrorCode::file_not_readable;
  return fail(code, fmt::format("Cannot read it: {}.", std::strerror(error)), {name});
}

/// Bytes of the regular file behind `file`.
[[nodiscard]] Result<std::uint64_t> size_of(const File& file, const std::string& name) {
  struct stat status {};
  if (file.descriptor() < 0 || ::fstat(file.descriptor(), &status) != 0) {
    return cannot_read(name, errno);
  }
  if (!S_ISREG(status.st_mode)) {
    return fail(ErrorCode::file_not_readable, "It is not a file.", {name});
  }
  return static_cast<std::uint64_t>(status.st_size);
}

[[nodiscard]] Result<std::string> read_whole(const File& file, std::uint64_t size,
                                             const std::string& name) {
  std::string text(size, '\0');
  std::size_t filled = 0;
  while (filled < text.size()) {
    const ssize_t count = ::read(file.descriptor(), text.data() + filled, text.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return cannot_read(name, errno);
    if (count == 0) break;  // became shorter meanwhile
    filled += static_cast<std::size_t>(count);
  }
  text.resize(filled);
  return text;
}

[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

[[nodiscard]] std::size_t find(char c, std::string_view text) {
  const void* found = std::memchr(text.data(), c, text.size());
  return found == nullptr ? std::string_view::npos
                          : static_cast<std::size_t>(static_cast<const char*>(found) - text.data());
}

/// Where the line that begins at `from` ends. In a truncated file, where gigabytes of NUL may
/// follow and no line end, behind the first NUL.
[[nodiscard]] std::size_t find_line_end(std::string_view text, std::size_t from) {
  constexpr std::size_t kNear = 1U << 16U;
  const std::string_view near = text.substr(from, kNear);
  if (const std::size_t end = find('\n', near); end != std::string_view::npos) return from + end;
  if (const std::size_t nul = find('\0', near); nul != std::string_view::npos)
    return from + nul + 1;
  const std::size_t end = find('\n', text.substr(from));
  return end == std::string_view::npos ? text.size() : from + end;
}

}  // namespace

Result<std::shared_ptr<const Program>> Program::open(const std::filesystem::path& path) {
  std::shared_ptr<Program> program(new Program(path.string()));
  const File file(path);
  const auto size = size_of(file, program->name_);
  if (!size) return std::unexpected(size.error());
  if (*size > kMaxBytes) {
    return fail(ErrorCode::program_too_large,
                fmt::format("The file has {} bytes; at most {} are possible.", *size, kMaxBytes),
                {program->name_});
  }
  if (*size <= kReadWhole) {
    auto text = read_whole(file, *size, program->name_);
    if (!text) return std::unexpected(text.error());
    program->owned_ = std::move(*text);
    program->text_ = program->owned_;
    return finish(std::move(program));
  }
  program->mapping_ = MappedFile::map(file.descriptor(), *size);
  if (!program->mapping_) return cannot_read(program->name_, errno);
  program->text_ = program->mapping_->text();
  return finish(std::move(program));
}

Result<std::shared_ptr<const Program>> Program::from_text(std::string text, std::string name) {
  std::shared_ptr<Program> program(new Program(std::move(name)));
  program->owned_ = std::move(text);
  program->text_ = program->owned_;
  return finish(std::move(program));
}

Result<std::shared_ptr<const Program>> Program::finish(std::shared_ptr<Program> program) {
  program->text_ = without_byte_order_mark(program->text_);
  if (Result<void> indexed = program->index(); !indexed) return std::unexpected(indexed.error());
  return program;
}

Result<void> Program::index() {
  if (text_.empty()) {
    return fail(ErrorCode::program_empty, "It is empty.", {name_});
  }
  std::uint32_t line = 0;
  for (std::size_t begin = 0; begin < text_.size();) {
    if (line == std::numeric_limits<std::uint32_t>::max()) {
      return fail(ErrorCode::program_too_large, "It has too many lines.", {name_});
    }
    ++line;
    if (line % kLinesPerEntry == 1) offsets_.push_back(begin);
    const std::size_t end = find_line_end(text_, begin);
    if (std::memchr(text_.data() + begin, '\0', end - begin) != nullptr) {
      return fail(ErrorCode::program_not_text, "It is not a text: this line holds a NUL byte.",
                  {name_, line});
    }
    if (text_[begin] == '%') nesting_.read(text_.substr(begin, end - begin));
    if (!flow_.look_at(text_.substr(begin, end - begin), line, begin)) {
      return fail(ErrorCode::program_too_large,
                  fmt::format("It has more than {} if, while and sub lines.", FlowIndex::kMaxMarks),
                  {name_, line});
    }
    begin = end + 1;
  }
  line_count_ = line;
  return {};
}

Program::Cursor Program::begin_of(std::uint32_t line) const {
  if (line == 0) line = 1;
  if (line > line_count_) return {line_count_ + 1, text_.size()};
  const std::uint32_t entry = (line - 1) / kLinesPerEntry;
  Cursor cursor{entry * kLinesPerEntry + 1, offsets_[entry]};
  while (cursor.line < line && !at_end(cursor)) static_cast<void>(read(cursor));
  return cursor;
}

std::string_view Program::line(std::uint32_t number) const {
  Cursor cursor = begin_of(number);
  return at_end(cursor) ? std::string_view{} : read(cursor);
}

std::string_view Program::read(Cursor& cursor) const {
  const std::size_t end = find_line_end(text_, cursor.offset);
  std::string_view text = text_.substr(cursor.offset, end - cursor.offset);
  cursor.offset = end + 1;
  ++cursor.line;
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

}  // namespace cnc::interp
