// The program list: pages on demand, the line in execution, lines that are wrong.
#include <QScrollBar>
#include <catch2/catch.hpp>

#include "gui/program_model.h"
#include "gui/program_panel.h"
#include "gui/program_view.h"
#include "tests/gui/support.h"

namespace cnc::gui::test {
namespace {

constexpr quint64 kHundredMillion = 100'000'000;

// A model whose pages are answered by hand; line n reads "N<n>".
struct Program {
  QApplication& app = application();
  ProgramModel model;
  std::vector<PageRequest> wanted;

  explicit Program(quint64 lines) {
    QObject::connect(&model, &ProgramModel::page_wanted, &model,
                     [this](const PageRequest& request) { wanted.push_back(request); });
    model.set_program(lines);
  }

  void answer(const PageRequest& request) {
    api::ProgramText text{request.first, {}};
    for (quint64 line = 0; line < request.count; ++line) {
      text.lines.push_back("N" + std::to_string(request.first + line));
    }
    model.take_page(request, text);
  }
  [[nodiscard]] std::string line(int row) const {
    return model.index(row).data().toString().toStdString();
  }
};

api::Problem problem_in_line(std::uint32_t line, bool warning) {
  api::Problem problem;
  problem.error.message = "unknown word";
  problem.error.place = api::TextPlace{"part.nc", line, 1};
  problem.warning = warning;
  return problem;
}

}  // namespace

TEST_CASE("Only the pages that are looked at are fetched, each once", "[gui][GUI-2]") {
  Program program(kHundredMillion);
  CHECK(program.model.rowCount() == 100'000'000);
  CHECK(program.wanted.empty());

  program.model.look_at(50'000'000, 50'000'010);
  program.model.look_at(50'000'001, 50'000'011);
  // Row 50 000 000 stands in page 195 312 (50 000 000 / 256 = 195 312.5), which begins with line
  // 195 312 * 256 + 1 = 49 999 873.
  REQUIRE(program.wanted.size() == 1);
  CHECK(program.wanted.front().first == 49'999'873);
  CHECK(program.wanted.front().count == 256);
  CHECK(program.line(50'000'000) == "…");

  program.answer(program.wanted.front());
  CHECK(program.line(50'000'000) == "N50000001");
}

TEST_CASE("The last page is as long as the file, not longer", "[gui][GUI-2]") {
  Program program(300);
  program.model.look_at(250, 400);
  REQUIRE(program.wanted.size() == 2);
  CHECK(program.wanted.back().first == 257);
  CHECK(program.wanted.back().count == 44);
}

TEST_CASE("Scrolling through a long file keeps a bounded number of pages", "[gui][GUI-2]") {
  Program program(kHundredMillion);
  for (int page = 0; page < 200; ++page) {
    program.model.look_at(page * 256, page * 256);
    program.answer(program.wanted.back());
  }
  CHECK(program.model.cached_pages() == ProgramModel::kMostPages);
  CHECK(program.line(199 * 256) == "N50945");  // 199 * 256 + 1
  CHECK(program.line(0) == "…");
}

TEST_CASE("A late answer for the program before is not shown in this one", "[gui][GUI-2]") {
  Program program(1000);
  program.model.look_at(0, 10);
  program.model.set_program(1000);
  program.answer(program.wanted.front());
  CHECK(program.line(0) == "…");
}

TEST_CASE("A page that could not be fetched is asked for again", "[gui][GUI-2]") {
  Program program(1000);
  program.model.look_at(0, 10);
  program.model.drop_page(program.wanted.front());
  program.model.look_at(0, 10);
  CHECK(program.wanted.size() == 2);
}

TEST_CASE("The line in execution and wrong lines are marked", "[gui][GUI-2]") {
  Program program(1000);
  program.model.set_current_line(7);
  program.model.set_problems({problem_in_line(20, false), problem_in_line(30, true)});
  CHECK(program.model.index(6).data(ProgramModel::kIsCurrent).toBool());
  CHECK_FALSE(program.model.index(7).data(ProgramModel::kIsCurrent).toBool());
  CHECK(program.model.index(19).data(ProgramModel::kProblem).toString() == "unknown word");
  CHECK_FALSE(program.model.index(19).data(ProgramModel::kIsWarning).toBool());
  CHECK(program.model.index(29).data(ProgramModel::kIsWarning).toBool());
  CHECK(program.model.next_problem_row(-1) == 19);
  CHECK(program.model.next_problem_row(19) == 29);
  CHECK(program.model.next_problem_row(29) == 19);
}

TEST_CASE("An error within a macro marks the job's line that led there", "[gui][LNG-6]") {
  Program program(1000);
  api::Problem problem = problem_in_line(300, false);
  problem.error.place->file = "/data/macro.cnc";
  problem.calls = {{"inner", {"/data/macro.cnc", 280, 0}}, {"outer", {"/jobs/part.nc", 5, 0}}};
  program.model.set_problems({problem});
  CHECK(program.model.next_problem_row(-1) == 4);
  CHECK(program.model.index(4).data(ProgramModel::kProblem).toString() ==
        "unknown word (inner, macro.cnc:300)");
}

TEST_CASE("The view asks for what it shows, and follows the line in execution", "[gui][GUI-2]") {
  Program program(kHundredMillion);
  ProgramView view(program.model);
  view.resize(500, 400);
  view.show();
  static_cast<void>(view.grab());
  REQUIRE_FALSE(program.wanted.empty());
  CHECK(program.wanted.front().first == 1);

  program.model.set_current_line(kHundredMillion);
  view.follow_current_line();
  CHECK(view.first_visible_row() + view.visible_rows() == 100'000'000);

  SECTION("until the operator scrolls away") {
    view.verticalScrollBar()->setValue(0);
    program.model.set_current_line(5'000);
    view.follow_current_line();
    CHECK(view.first_visible_row() == 0);
  }
}

TEST_CASE("Progress says percent, elapsed and remaining time", "[gui][GUI-2]") {
  application();
  ProgramPanel panel;
  auto status = status_with(api::MachineState::running, {});
  status.job.path = "/jobs/part.nc";
  status.job.lines = 1'234'567;
  status.job.progress = 0.42;
  status.job.elapsed = 65.0;
  status.job.prediction_ready = true;
  status.job.time_left = 3'725.0;  // 1 h, 2 min, 5 s
  panel.show_status(status);
  CHECK(child<QProgressBar>(panel, "progress").text() == "42 %");
  CHECK(child<QLabel>(panel, "times").text().toStdString() == "1:05  ·  1:02:05 left");
  CHECK(child<QLabel>(panel, "program_title").text().contains("part.nc"));
}

}  // namespace cnc::gui::test
