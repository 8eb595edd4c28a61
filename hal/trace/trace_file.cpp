#include "hal/trace/trace_file.h"

#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <optional>

#include "hal/cpu5/wire/crc32.h"
#include "hal/trace/ring.h"
#include "hal/trace/trace_check.h"

namespace cnc::hal::trace {
namespace {

constexpr std::string_view kMagic = "CNCTRACE";
constexpr std::uintmax_t kLargestFile = std::uintmax_t{64} << 20U;

enum class Section : std::uint32_t { end = 0, about = 1, config = 2, layout = 3, records = 4 };

// --- bytes ---------------------------------------------------------------------------------------

std::uint32_t crc_of(std::string_view bytes) {
  return cpu5::wire::crc32(
      {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});  // NOLINT
}

void put_number(std::string& out, std::uint32_t number) {
  std::array<char, sizeof number> bytes{};
  std::memcpy(bytes.data(), &number, sizeof number);
  out.append(bytes.data(), bytes.size());
}

void put_section(std::string& out, Section section, std::string_view content) {
  put_number(out, static_cast<std::uint32_t>(section));
  put_number(out, static_cast<std::uint32_t>(content.size()));
  out += content;
  put_number(out, crc_of(content));
}

/// Takes sections off the front of a file.
class SectionReader {
 public:
  SectionReader(std::string_view bytes, std::string_view name) : bytes_(bytes), name_(name) {}

  /// The content of the next section, which has to be this one.
  [[nodiscard]] Result<std::string_view> take(Section section) {
    const auto tag = number();
    const auto size = number();
    if (!tag || !size || bytes_.size() < *size) return damaged("ends in the middle");
    const std::string_view content = bytes_.substr(0, *size);
    bytes_.remove_prefix(*size);
    const auto crc = number();
    if (!crc) return damaged("ends in the middle");
    if (*tag != static_cast<std::uint32_t>(section) || *crc != crc_of(content))
      return damaged("is damaged: its check sums do not fit");
    return content;
  }
  [[nodiscard]] std::unexpected<Error> damaged(std::string_view how) const {
    return fail(ErrorCode::trace_damaged, fmt::format("The trace file {} {}.", name_, how));
  }

 private:
  [[nodiscard]] std::optional<std::uint32_t> number() {
    std::uint32_t value = 0;
    if (bytes_.size() < sizeof value) return std::nullopt;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }

  std::string_view bytes_;
  std::string_view name_;
};

// --- what stands in front ------------------------------------------------------------------------

std::string about_text(const About& about) {
  return fmt::format(
      "reason {}\nwritten {}\nserver {}\nboard {}\nmax_step_frequency {}\nhost_timeout {}\n"
      "index_timeout {}\ndrives_off_on_fault {}\n",
      about.reason, about.written, about.server, about.board, about.driver.max_step_frequency,
      about.driver.host_timeout, about.driver.index_timeout,
      about.driver.drives_off_on_fault ? 1 : 0);
}

/// What a line "key value" of the text says; empty if there is none.
std::string_view value_of(std::string_view text, std::string_view key) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (line.starts_with(key) && line.substr(key.size()).starts_with(' '))
      return line.substr(key.size() + 1);
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return {};
}

bool read_number(std::string_view text, std::string_view key, double& into) {
  const std::string_view value = value_of(text, key);
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), into);
  return error == std::errc{} && end == value.data() + value.size();
}

bool read_about(std::string_view text, About& about) {
  about.reason = value_of(text, "reason");
  about.written = value_of(text, "written");
  about.server = value_of(text, "server");
  about.board = value_of(text, "board");
  double drives_off = 0.0;
  const bool good = read_number(text, "max_step_frequency", about.driver.max_step_frequency) &&
                    read_number(text, "host_timeout", about.driver.host_timeout) &&
                    read_number(text, "index_timeout", about.driver.index_timeout) &&
                    read_number(text, "drives_off_on_fault", drives_off);
  about.driver.drives_off_on_fault = drives_off != 0.0;
  return good;
}

// --- records -------------------------------------------------------------------------------------

std::span<const std::byte> fields_of(std::span<const std::uint64_t> record, RecordHead head) {
  return std::as_bytes(record.subspan(1)).first(head.bytes);
}

template <typename T>
bool decode(std::span<const std::byte> bytes, T& into) {
  Decoder decoder(bytes);
  visit_fields(decoder, into);
  return decoder.at_end() && !decoder.bad();
}

/// A record of whichever kind it says.
template <std::size_t Index = 0>
bool decode_request(Kind kind, std::span<const std::byte> bytes, std::vector<Request>& into) {
  if constexpr (Index == std::variant_size_v<Request>) {
    return false;
  } else {
    if (kind != Index + 1) return decode_request<Index + 1>(kind, bytes, into);
    std::variant_alternative_t<Index, Request> request{};
    if (!decode(bytes, request)) return false;
    into.emplace_back(request);
    return true;
  }
}

/// Calls `visit(head, record)` for each; false if one does not end where the records do.
template <typename Visit>
bool for_each_record(std::span<const std::uint64_t> records, Visit visit) {
  while (!records.empty()) {
    const RecordHead head = RecordHead::from(records.front());
    if (head.words() > records.size() || !visit(head, records.first(head.words()))) return false;
    records = records.subspan(head.words());
  }
  return true;
}

/// Behind the last exchange that is older than `seconds` before the newest.
std::span<const std::uint64_t> newest(std::span<const std::uint64_t> records, double seconds) {
  struct Place {
    double now;
    std::size_t end;
  };
  std::vector<Place> exchanges;
  std::size_t end = 0;
  for_each_record(records, [&](RecordHead head, std::span<const std::uint64_t> record) {
    end += record.size();
    if (head.kind != kExchange) return true;
    Exchange exchange;
    static_cast<void>(decode(fields_of(record, head), exchange));
    exchanges.push_back({exchange.now, end});
    return true;
  });
  std::size_t begin = 0;
  for (const Place& each : exchanges)
    if (each.now < exchanges.back().now - seconds) begin = each.end;
  return records.subspan(begin);
}

std::size_t count_requests(std::span<const std::uint64_t> records) {
  std::size_t count = 0;
  for_each_record(records, [&](RecordHead head, std::span<const std::uint64_t>) {
    if (head.kind != kExchange) ++count;
    return true;
  });
  return count;
}

bool read_steps(std::span<const std::uint64_t> records, std::vector<Step>& steps) {
  Step step;
  return for_each_record(records, [&](RecordHead head, std::span<const std::uint64_t> record) {
    const auto fields = fields_of(record, head);
    if (head.kind != kExchange) return decode_request(head.kind, fields, step.requests);
    if (!decode(fields, step.exchange)) return false;
    steps.push_back(std::move(step));
    step = {};
    return true;
  });
}

// --- layout --------------------------------------------------------------------------------------

template <typename T>
std::string type_text() {
  if constexpr (kIsBits<T>) return "u64";
  if constexpr (std::is_floating_point_v<T>) return fmt::format("f{}", 8 * sizeof(T));
  return fmt::format("{}{}", std::is_signed_v<T> ? 'i' : 'u', 8 * sizeof(T));
}

template <typename T>
void add_layout(std::string& text, Kind kind) {
  text += fmt::format("record {}\n", kind);
  FieldText lines([&](const std::string& name, const auto& value) {
    text += fmt::format("{} {}\n", name, type_text<std::remove_cvref_t<decltype(value)>>());
  });
  T record{};
  visit_fields(lines, record);
}

}  // namespace

std::string layout() {
  std::string text;
  add_layout<Exchange>(text, kExchange);
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (add_layout<std::variant_alternative_t<I, Request>>(text, Kind{I + 1}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Request>>());
  return text;
}

std::string trace_bytes(const About& about, std::span<const std::uint64_t> records,
                        double seconds) {
  const auto kept = std::as_bytes(newest(records, seconds));
  std::string out(kMagic);
  put_section(out, Section::about, about_text(about));
  put_section(out, Section::config, about.config);
  put_section(out, Section::layout, layout());
  put_section(out, Section::records,
              {reinterpret_cast<const char*>(kept.data()), kept.size()});  // NOLINT
  put_section(out, Section::end, {});
  return out;
}

Result<Trace> parse_trace(std::string_view bytes, std::string_view name) {
  if (!bytes.starts_with(kMagic))
    return fail(ErrorCode::not_a_trace,
                fmt::format("{} is no trace file: it does not begin with {}.", name, kMagic));
  SectionReader reader(bytes.substr(kMagic.size()), name);
  Trace trace;
  const auto about = reader.take(Section::about);
  if (!about) return std::unexpected(about.error());
  if (!read_about(*about, trace.about)) return reader.damaged("lacks values at its beginning");
  const auto config = reader.take(Section::config);
  if (!config) return std::unexpected(config.error());
  trace.about.config = *config;
  const auto written_as = reader.take(Section::layout);
  if (!written_as) return std::unexpected(written_as.error());
  const auto records = reader.take(Section::records);
  if (!records) return std::unexpected(records.error());
  if (auto end = reader.take(Section::end); !end) return std::unexpected(end.error());
  if (*written_as != layout())
    return fail(ErrorCode::trace_of_other_version,
                fmt::format("The trace file {} was written by version {}, which records other "
                            "fields than this one.",
                            name, trace.about.server));
  if (records->size() % sizeof(std::uint64_t) != 0)
    return reader.damaged("has a record that is none");
  std::vector<std::uint64_t> words(records->size() / sizeof(std::uint64_t));
  if (!words.empty()) std::memcpy(words.data(), records->data(), records->size());
  if (count_requests(words) > kMostRequests)
    return reader.damaged(fmt::format("has more than {} requests", kMostRequests));
  if (!read_steps(words, trace.steps)) return reader.damaged("has a record that is none");
  if (trace.steps.empty()) return reader.damaged("has no exchange in it");
  if (const auto nonsense = what_no_server_writes(trace)) return reader.damaged(*nonsense);
  return trace;
}

Result<Trace> read_trace(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error)
    return fail(ErrorCode::file_not_found,
                fmt::format("Cannot read {}: {}.", path.string(), error.message()));
  if (size > kLargestFile)
    return fail(ErrorCode::not_a_trace,
                fmt::format("{} is no trace file: it is too large.", path.string()));
  std::string bytes(size, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size)))
    return fail(ErrorCode::file_not_readable, fmt::format("Cannot read {}.", path.string()));
  return parse_trace(bytes, path.string());
}

}  // namespace cnc::hal::trace
