// The texts of a run: the job and the macro files beside it, and where their subs are.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "interpreter/program.h"

namespace cnc::interp {

/// Macro files, the system's first; a sub of a later file counts before one of an earlier.
using Library = std::vector<std::shared_ptr<const Program>>;

class Sources {
 public:
  static constexpr std::uint16_t kJob = 0;

  void set_job(std::shared_ptr<const Program> job) { files_[kJob] = std::move(job); }
  void set_library(const Library& library);

  [[nodiscard]] bool has_job() const { return files_[kJob] != nullptr; }
  [[nodiscard]] std::uint16_t count() const { return static_cast<std::uint16_t>(files_.size()); }
  [[nodiscard]] const Program& file(std::uint16_t index) const { return *files_[index]; }

  struct Sub {
    std::uint16_t file = kJob;
    const FlowMark* begin = nullptr;  ///< nullptr: there is none
    std::uint32_t other_line = 0;     ///< of a second sub with this name in the same file
  };
  /// The job's subs come before those of the macro files.
  [[nodiscard]] Sub find_sub(std::string_view name) const;

 private:
  std::vector<std::shared_ptr<const Program>> files_{nullptr};  ///< [0] is the job
};

}  // namespace cnc::interp
