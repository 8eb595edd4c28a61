// A terminal (pseudo-terminal) at which a test sits.
#pragma once

#include <string>
#include <string_view>

namespace cnc::test {

class Terminal {
 public:
  Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal();

  /// To be opened by the program that reads from it.
  [[nodiscard]] const std::string& path() const { return path_; }
  void type(std::string_view keys) const;

  static constexpr std::string_view kControlD = "\x04";

 private:
  int keyboard_ = -1;
  std::string path_;
};

}  // namespace cnc::test
