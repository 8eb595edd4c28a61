// A machine with macro files of its own, and things to probe.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/config/temporary_directory.h"
#include "tests/server/rig.h"

namespace cnc::server::test {

inline constexpr double kSetterTop =
    -100.0;  // machine Z at which the bare spindle touches the setter
inline constexpr double kStockTop = -80.0;

/// Ready, with a stock and a tool setter.
class MacroRig {
 public:
  explicit MacroRig(std::string_view macros, std::vector<std::string> settings = {},
                    bool mandatory_homing = false);

  /// Runs a single line and answers what it asks, as an operator would.
  Result<void> run(const std::string& line, const std::vector<double>& values = {},
                   bool confirmed = true);
  /// All messages so far, each ended by "|".
  [[nodiscard]] std::string messages() const;

  config::test::TemporaryDirectory folder;
  Rig rig;
  std::function<void()> on_stop;  ///< what the operator does before he resumes

 private:
  [[nodiscard]] bool waits_for_operator() const;
  [[nodiscard]] MachineData data(std::string_view macros, std::vector<std::string> settings,
                                 bool mandatory_homing) const;
};

}  // namespace cnc::server::test
