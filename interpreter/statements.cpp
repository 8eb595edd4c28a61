#include "interpreter/statements.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <optional>

#include "interpreter/block.h"
#include "interpreter/execution.h"
#include "interpreter/expression_parser.h"
#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

[[nodiscard]] bool is_word(std::string_view text, std::string_view lower) {
  return std::ranges::equal(text, lower, {}, upper, upper);
}

template <typename Value>
struct NamedValue {
  std::string_view name;
  Value value;
};

/// The value that a word stands for.
template <typename Value, std::size_t size>
Parsed<Value> value_named(const Argument& argument,
                          const std::array<NamedValue<Value>, size>& names) {
  std::string all;
  for (const NamedValue<Value>& row : names) {
    if (is_word(argument.text, row.name)) return row.value;
    all.append(all.empty() ? "" : " ").append(row.name);
  }
  return refuse(ErrorCode::statement_argument, argument.span,
                fmt::format("\"{}\" is not possible here.", argument.text), all);
}

constexpr auto kOnOff = std::to_array<NamedValue<bool>>({{"on", true}, {"off", false}});
constexpr auto kAxes = std::to_array<NamedValue<Axis>>({{"x", Axis::X},
                                                        {"y", Axis::Y},
                                                        {"z", Axis::Z},
                                                        {"a", Axis::A},
                                                        {"b", Axis::B},
                                                        {"c", Axis::C}});

template <Guard guard>
Accepted set_guard(Execution& x, Arguments arguments) {
  const auto on = value_named(arguments[0], kOnOff);
  if (!on) return std::unexpected(on.error());
  x.emit(SetGuard{guard, *on});
  return {};
}

Accepted home_is_estop(Execution& x, Arguments arguments) {
  const auto on = value_named(arguments[0], kOnOff);
  if (!on) return std::unexpected(on.error());
  x.emit(UseHomeSensorsAsEstop{*on});
  return {};
}

template <HomeStep step>
Accepted home(Execution& x, Arguments arguments) {
  const auto axis = value_named(arguments[0], kAxes);
  if (!axis) return std::unexpected(axis.error());
  if (*axis == Axis::A && x.state().modal.a_clamped) {
    return refuse(ErrorCode::axis_clamped, arguments[0].span,
                  "The A axis is clamped (M26): it cannot be homed.", "M27 on a line before.");
  }
  x.emit(HomeAxis{step, *axis});
  return {};
}

// The angle stays until the next G61 or G64 with R.
Accepted set_laf_angle(Execution& x, Arguments arguments) {
  const double angle = arguments[0].value;
  if (angle < 0.0 || angle > 180.0) {
    return refuse(ErrorCode::word_out_of_range, arguments[0].span,
                  fmt::format("The look-ahead angle cannot be {:.6g} degrees.", angle),
                  "0 to 180 degrees.");
  }
  SetPathMode& path = x.state().modal.path;
  path.laf_angle = angle;
  x.emit(path);
  return {};
}

Accepted ask_operator(Execution& x, Arguments arguments) {
  Dialog dialog{.title = arguments[0].text, .fields = {}};
  for (std::size_t i = 1; i < arguments.size(); i += 2) {
    const auto number = parameter_number(arguments[i + 1].value, arguments[i + 1].span);
    if (!number) return std::unexpected(number.error());
    dialog.fields.push_back({arguments[i].text, *number, x.parameter(*number)});
  }
  x.ask(std::move(dialog));
  return {};
}

/// The 0 or 1 behind a file's name.
Parsed<bool> append_flag(Arguments arguments, bool otherwise) {
  if (arguments.size() < 2) return otherwise;
  const auto flag = whole_number(arguments[1].value);
  if (flag == 0 || flag == 1) return flag == 1;
  return refuse(ErrorCode::statement_argument, arguments[1].span,
                "Behind the file's name stands 0 or 1.", "0 for a new file, 1 to add to it.");
}

Accepted open_log_file(Execution& x, Arguments arguments) {
  const auto append = append_flag(arguments, false);
  if (!append) return std::unexpected(append.error());
  x.emit(OpenLogFile{arguments[0].text, *append});
  return {};
}

Accepted store_position(Execution& x, Arguments arguments) {
  const auto append = append_flag(arguments, true);
  if (!append) return std::unexpected(append.error());
  Position position = x.state().work_position();
  if (x.state().diameter_programming) position[Axis::X] *= 2.0;  // as a program writes it
  x.emit(StorePosition{arguments[0].text, *append, position});
  return {};
}

constexpr auto kKnifeCommands =
    std::to_array<NamedValue<KnifeCommand>>({{"off", KnifeCommand::off},
                                             {"on", KnifeCommand::on},
                                             {"b", KnifeCommand::use_b},
                                             {"c", KnifeCommand::use_c},
                                             {"lo", KnifeCommand::set_low},
                                             {"hi", KnifeCommand::set_high}});

Accepted set_knife(Execution& x, Arguments arguments) {
  const auto command = value_named(arguments[0], kKnifeCommands);
  if (!command) return std::unexpected(command.error());
  if (arguments.size() == 1) {
    x.emit(SetKnife{*command});
    return {};
  }
  const double angle = arguments[1].value;
  if (*command != KnifeCommand::on || (angle != 90.0 && angle != -90.0)) {
    return refuse(ErrorCode::statement_argument, arguments[1].span,
                  "A knife is bent to 90 or to -90.", "tanknife on, on 90, on -90");
  }
  x.emit(SetKnife{angle > 0.0 ? KnifeCommand::on_bent_left : KnifeCommand::on_bent_right});
  return {};
}

Accepted switch_height_map(Execution& x, Arguments arguments) {
  const auto on = value_named(arguments[0], kOnOff);
  if (!on) return std::unexpected(on.error());
  x.emit(ChangeHeightMap{.command = *on ? HeightMapCommand::on : HeightMapCommand::off});
  return {};
}

Accepted begin_height_map(Execution& x, Arguments arguments) {
  constexpr std::int32_t kMaxPoints = 1000;  // along one side
  const double size = arguments[0].value * x.state().scale();
  const auto columns = whole_number(arguments[1].value);
  const auto rows = whole_number(arguments[2].value);
  const auto possible = [](const std::optional<std::int32_t>& count) {
    return count && *count >= 1 && *count <= kMaxPoints;
  };
  if (size <= 0.0 || !possible(columns) || !possible(rows)) {
    return refuse(ErrorCode::statement_argument, arguments[0].span,
                  "This is not the size of a grid.",
                  fmt::format("Grid size above 0, 1 to {} columns and rows.", kMaxPoints));
  }
  x.emit(ChangeHeightMap{HeightMapCommand::begin, size, *columns, *rows, {}});
  return {};
}

Accepted add_height_point(Execution& x, Arguments) {
  x.emit(ChangeHeightMap{.command = HeightMapCommand::add_point});
  return {};
}

Accepted store_height_map(Execution& x, Arguments arguments) {
  ChangeHeightMap store{.command = HeightMapCommand::store};
  store.name = arguments[0].text;
  x.emit(store);
  return {};
}

// clang-format off
constexpr auto kStatements = std::to_array<SpecialStatement>({
    {"dlgmsg",            "w(wn)*", "dlgmsg \"title\" \"label\" number ...",  ask_operator},
    {"logfile",           "w|wn",   "logfile \"name\" 0|1",                   open_log_file},
    {"sp",                "w|wn",   "sp \"name\" 0|1",                        store_position},
    {"tcaguard",          "w",      "tcaguard on|off",                        set_guard<Guard::tool_change_area>},
    {"mcaguard",          "w",      "mcaguard on|off",                        set_guard<Guard::machine_area>},
    {"homeisestop",       "w",      "homeisestop on|off",                     home_is_estop},
    {"setlafangle",       "n",      "setlafangle angle",                      set_laf_angle},
    {"home",              "w",      "home x",                                 home<HomeStep::home>},
    {"hometandem",        "w",      "hometandem x",                           home<HomeStep::tandem>},
    {"preparetandemhome", "w",      "preparetandemhome x",                    home<HomeStep::prepare_tandem>},
    {"moveslavetomaster", "w",      "moveslavetomaster a",                    home<HomeStep::move_slave_to_master>},
    {"movestavetomaster", "w",      "moveslavetomaster a",                    home<HomeStep::move_slave_to_master>},  // manual 2.10.3
    {"tanknife",          "w|wn",   "tanknife on|off|b|c|lo|hi, tanknife on 90|-90", set_knife},
    {"zhc",               "w",      "zhc on|off",                             switch_height_map},
    {"zhcinit",           "nnn",    "zhcinit gridsize nx ny",                 begin_height_map},
    {"zhcaddpoint",       "",       "zhcaddpoint",                            add_height_point},
    {"zhcs",              "w",      "zhcs \"name\"",                          store_height_map},
});
// clang-format on

[[nodiscard]] bool fits_shape(std::string_view shape, Arguments arguments) {
  constexpr std::string_view kPairs = "(wn)*";
  const bool pairs = shape.ends_with(kPairs);
  if (pairs) shape.remove_suffix(kPairs.size());
  if (arguments.size() < shape.size()) return false;
  if (!pairs && arguments.size() != shape.size()) return false;
  if (pairs && (arguments.size() - shape.size()) % 2 != 0) return false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const bool text = i < shape.size() ? shape[i] == 'w' : (i - shape.size()) % 2 == 0;
    if (arguments[i].is_text != text) return false;
  }
  return true;
}

}  // namespace

std::span<const SpecialStatement> special_statements() { return kStatements; }

bool fits(const SpecialStatement& statement, Arguments arguments) {
  std::string_view rest = statement.shapes;
  for (;;) {
    const std::size_t end = std::min(rest.find('|'), rest.size());
    if (fits_shape(rest.substr(0, end), arguments)) return true;
    if (end == rest.size()) return false;
    rest.remove_prefix(end + 1);
  }
}

}  // namespace cnc::interp
