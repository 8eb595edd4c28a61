// Completion scripts, made from the tree of commands, so that they cannot go stale.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>

namespace cnc::ctl {

struct Shell {
  std::string name;
  std::string description;
  std::string (*script)(const CLI::App& root);
};

/// bash, zsh and fish.
[[nodiscard]] std::span<const Shell> shells();

}  // namespace cnc::ctl
