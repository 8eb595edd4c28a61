#include "api/cncctl/completion.h"

#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <vector>

namespace cnc::ctl {
namespace {

std::vector<const CLI::App*> subcommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// "--feed", …; no positionals.
std::vector<std::string> long_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// Calls `visit(app, "cncctl override")` for every node of the tree.
void walk(const CLI::App& app, const std::string& path,
          const std::function<void(const CLI::App&, const std::string&)>& visit) {
  visit(app, path);
  for (const CLI::App* child : subcommands(app))
    walk(*child, path + ' ' + child->get_name(), visit);
}

/// What may follow a node of the tree, global options included.
std::vector<std::string> candidates(const CLI::App& app, const CLI::App& root) {
  std::vector<std::string> words;
  for (const CLI::App* child : subcommands(app)) words.push_back(child->get_name());
  for (const std::string& name : long_options(app)) words.push_back(name);
  if (&app != &root) {
    for (const std::string& name : long_options(root)) {
      if (name != "--help") words.push_back(name);
    }
  }
  return words;
}

/// The function walks down the tree along the words typed so far, then offers what may follow
/// there; where nothing fits, the shell completes file names.
std::string bash_script(const CLI::App& root) {
  std::vector<std::string> paths;
  std::string cases;
  walk(root, "cncctl", [&](const CLI::App& app, const std::string& path) {
    if (&app != &root) paths.push_back('"' + path + '"');
    cases +=
        fmt::format("    \"{}\") words=\"{}\" ;;\n", path, fmt::join(candidates(app, root), " "));
  });
  return fmt::format(R"(# cncctl completion bash: source this file
_cncctl() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" path="cncctl" words="" i
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$path ${{COMP_WORDS[i]}}" in
    {}) path="$path ${{COMP_WORDS[i]}}" ;;
    esac
  done
  case "$path" in
{}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F _cncctl cncctl
)",
                     fmt::join(paths, "|"), cases);
}

std::string zsh_script(const CLI::App& root) {
  return "# cncctl completion zsh: source this file; zsh runs completions written for bash\n"
         "autoload -U +X compinit && compinit\n"
         "autoload -U +X bashcompinit && bashcompinit\n" +
         bash_script(root);
}

std::string fish_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '\'';
}

std::string fish_options(const CLI::App& app, const std::string& condition) {
  std::string lines;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      lines += fmt::format("complete -c cncctl {} -l {} -d {}\n", condition, name,
                           fish_quoted(option->get_description()));
    }
  }
  return lines;
}

/// "-n '…'": true when exactly the words of this node have been typed, and none of its children.
std::string fish_condition(const CLI::App& app, const std::string& path) {
  std::string condition;
  for (std::size_t at = path.find(' '); at != std::string::npos; at = path.find(' ', at + 1)) {
    const std::size_t end = path.find(' ', at + 1);
    condition += "__fish_seen_subcommand_from " + path.substr(at + 1, end - at - 1) + "; and ";
  }
  std::string children;
  for (const CLI::App* child : subcommands(app)) children += ' ' + child->get_name();
  condition += children.empty() ? "true" : "not __fish_seen_subcommand_from" + children;
  return "-n " + fish_quoted(condition);
}

std::string fish_script(const CLI::App& root) {
  std::string script = "# cncctl completion fish: source this file\n" + fish_options(root, "");
  walk(root, "cncctl", [&](const CLI::App& app, const std::string& path) {
    const std::string condition = fish_condition(app, path);
    for (const CLI::App* child : subcommands(app)) {
      script += fmt::format("complete -c cncctl -f {} -a {} -d {}\n", condition, child->get_name(),
                            fish_quoted(child->get_description()));
    }
    if (&app != &root) script += fish_options(app, condition);
  });
  return script;
}

}  // namespace

std::span<const Shell> shells() {
  static const std::array<Shell, 3> kShells{
      Shell{"bash", "For bash: source <(cncctl completion bash)", bash_script},
      Shell{"zsh", "For zsh: source <(cncctl completion zsh)", zsh_script},
      Shell{"fish", "For fish: cncctl completion fish | source", fish_script}};
  return kShells;
}

}  // namespace cnc::ctl
