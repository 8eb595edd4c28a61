// The tree of commands and options: the one description from which parsing, --help and the shells'
// completion are made.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "api/cncctl/context.h"

namespace cnc::ctl {

/// Parsing fills `task`, which has to outlive the answer.
[[nodiscard]] std::unique_ptr<CLI::App> make_command_line(Task& task);

// Each adds its commands to the tree.
void add_info_commands(CLI::App& app, Task& task);
void add_link_command(CLI::App& app, Task& task);
void add_machine_commands(CLI::App& app, Task& task);
void add_job_commands(CLI::App& app, Task& task);
void add_answer_command(CLI::App& app, Task& task);

}  // namespace cnc::ctl
