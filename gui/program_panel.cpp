#include "gui/program_panel.h"

#include <QHBoxLayout>
#include <QVBoxLayout>
#include <algorithm>

#include "gui/style.h"
#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr int kProgressSteps = 1000;

QString title_text(const api::JobStatus& job) {
  if (job.path.empty()) return ProgramPanel::tr("No program");
  QString text =
      ProgramPanel::tr("%1  ·  %2 lines").arg(file_name_text(job.path), count_text(job.lines));
  if (job.line > 0) text += ProgramPanel::tr("  ·  line %1").arg(count_text(job.line));
  return text;
}

QString times_text(const api::JobStatus& job) {
  if (job.path.empty()) return {};
  QString text = duration_text(job.elapsed);
  if (job.prediction_ready) {
    text += ProgramPanel::tr("  ·  %1 left").arg(duration_text(job.time_left));
  }
  return text;
}

}  // namespace

ProgramPanel::ProgramPanel(QWidget* parent)
    : QWidget(parent),
      view_(new ProgramView(model_, this)),
      title_(new QLabel(this)),
      problems_(new QPushButton(this)),
      progress_(new QProgressBar(this)),
      times_(new QLabel(this)) {
  auto* const head = new QHBoxLayout;
  head->addWidget(title_, 1);
  head->addWidget(problems_);
  auto* const foot = new QHBoxLayout;
  foot->addWidget(progress_, 1);
  foot->addWidget(times_);
  auto* const column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(4);
  column->addLayout(head);
  column->addWidget(view_, 1);
  column->addLayout(foot);

  title_->setProperty("role", "header");
  title_->setMinimumHeight(36);
  title_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  title_->setObjectName(QStringLiteral("program_title"));
  problems_->setObjectName(QStringLiteral("problems"));
  problems_->setProperty("tone", "red");
  problems_->setFocusPolicy(Qt::NoFocus);
  problems_->hide();
  progress_->setRange(0, kProgressSteps);
  progress_->setFixedHeight(24);
  progress_->setFormat(QStringLiteral("0 %"));
  progress_->setObjectName(QStringLiteral("progress"));
  times_->setProperty("role", "value");
  times_->setObjectName(QStringLiteral("times"));
  connect(problems_, &QPushButton::clicked, this, [this] {
    problem_row_ = model_.next_problem_row(problem_row_);
    if (problem_row_ >= 0) view_->go_to(problem_row_);
  });
}

void ProgramPanel::show_status(const api::MachineStatus& status) {
  const api::JobStatus& job = status.job;
  if (job.path != path_ || job.lines != lines_) show_job(job.path, job.lines);
  if (job.problems != known_problems_) {
    known_problems_ = job.problems;
    emit problems_wanted();
  }
  set_text(*title_, title_text(job));
  set_text(*problems_, tr("✖ %1 wrong ▸").arg(count_text(job.problems)));
  problems_->setVisible(job.problems > 0);
  model_.set_current_line(job.line);
  view_->follow_current_line();
  show_progress(job);
}

void ProgramPanel::show_progress(const api::JobStatus& job) {
  const int steps = static_cast<int>(std::clamp(job.progress, 0.0, 1.0) * kProgressSteps);
  progress_->setValue(steps);
  progress_->setFormat(percent_text(static_cast<double>(steps) / kProgressSteps));
  set_text(*times_, times_text(job));
}

void ProgramPanel::show_job(const std::string& path, quint64 lines) {
  path_ = path;
  lines_ = lines;
  known_problems_ = 0;
  problem_row_ = -1;
  model_.set_program(lines);
}

void ProgramPanel::show_loaded(const api::LoadedJob& job) { show_job(job.path, job.lines); }

void ProgramPanel::forget() { show_job({}, 0); }

void ProgramPanel::show_problems(const api::ProblemList& problems) {
  model_.set_problems(problems.problems);
}

}  // namespace cnc::gui
