// A large file as memory: it is there at once and takes none.
//
// Whoever truncates a mapped file takes the memory away from under its readers: the next access
// behind the new end raises SIGBUS, which would end the process with a machine in motion. A handler
// puts zeros in place of what was lost, as libwayland does for the buffers of its clients, and the
// reader goes on. A text holds no NUL, so the reader knows it when he sees one.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

namespace cnc::interp {

class MappedFile {
 public:
  /// The first `size` bytes of an open file, more than 0. Null when the system refuses (errno says
  /// why). From then on the process handles SIGBUS; signals that belong to no mapped file are left
  /// to who handled them before.
  [[nodiscard]] static std::unique_ptr<const MappedFile> map(int descriptor, std::size_t size);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::string_view text() const { return {begin_, size_}; }

 private:
  MappedFile(char* begin, std::size_t size) : begin_(begin), size_(size) {}

  char* begin_;
  std::size_t size_;
};

}  // namespace cnc::interp
