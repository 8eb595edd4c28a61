// `run --wait` and `run --progress`: start the job, follow it, tell how it ended.
#pragma once

#include "api/cncctl/context.h"

namespace cnc::ctl {

struct RunOptions {
  bool show_progress = false;
  /// Answers M0, M1 and tool changes with "resume" and questions with OK; never a pause. Without
  /// it, questions are shown, and asked on the terminal.
  bool go_on = false;
};

/// ok if the job reached its end; an Error with the machine's last error message if not. Losing the
/// server is an error too: the job goes on if the server does. Ctrl-C answers `interrupted`.
[[nodiscard]] api::Result<ExitCode> run_and_wait(const Context& context, const RunOptions& options);

}  // namespace cnc::ctl
