#include "gui/program_model.h"

#include <algorithm>
#include <limits>

#include "gui/text.h"

namespace cnc::gui {
namespace {

/// Where the job is wrong: for an error within a macro, the job's line that led there.
const api::TextPlace* place_in_job(const api::Problem& problem) {
  if (!problem.calls.empty()) return &problem.calls.back().place;
  return problem.error.place ? &*problem.error.place : nullptr;
}

QString problem_text(const api::Problem& problem) {
  QString text = to_text(problem.error.message);
  if (problem.calls.empty() || !problem.error.place) return text;
  const api::TextPlace& place = *problem.error.place;
  return text + QStringLiteral(" (%1, %2:%3)")
                    .arg(to_text(problem.calls.front().sub), file_name_text(place.file))
                    .arg(place.line);
}

quint64 page_of_line(quint64 line) { return (line - 1) / ProgramModel::kPageLines; }

}  // namespace

void ProgramModel::set_program(quint64 lines) {
  beginResetModel();
  ++job_;
  lines_ = std::min<quint64>(lines, std::numeric_limits<int>::max());
  current_line_ = 0;
  pages_.clear();
  ages_.clear();
  wanted_.clear();
  problems_.clear();
  endResetModel();
}

void ProgramModel::set_current_line(quint64 line) {
  if (line == current_line_) return;
  const int before = current_row();
  current_line_ = std::min(line, lines_);
  row_changed(before, {kIsCurrent});
  row_changed(current_row(), {kIsCurrent});
}

void ProgramModel::set_problems(const std::vector<api::Problem>& problems) {
  problems_.clear();
  for (const api::Problem& problem : problems) {
    const api::TextPlace* const place = place_in_job(problem);
    if (place == nullptr || place->line == 0) continue;
    problems_.try_emplace(static_cast<int>(place->line) - 1, problem_text(problem),
                          problem.warning);
  }
  if (lines_ > 0) emit dataChanged(index(0), index(rowCount() - 1), {kProblem, kIsWarning});
}

void ProgramModel::look_at(int first_row, int last_row) {
  if (lines_ == 0) return;
  const auto last = std::min<quint64>(static_cast<quint64>(std::max(last_row, 0)), lines_ - 1);
  const auto first = std::min<quint64>(static_cast<quint64>(std::max(first_row, 0)), last);
  for (quint64 page = first / kPageLines; page <= last / kPageLines; ++page) look_at_page(page);
}

void ProgramModel::look_at_page(quint64 page) {
  if (const auto found = pages_.find(page); found != pages_.end()) {
    ages_.splice(ages_.begin(), ages_, found->second.age);
    return;
  }
  if (wanted_.contains(page)) return;
  wanted_.insert(page);
  const quint64 first_row = page * kPageLines;
  const auto count = static_cast<quint32>(std::min(kPageLines, lines_ - first_row));
  emit page_wanted({job_, first_row + 1, count});
}

void ProgramModel::take_page(const PageRequest& request, const api::ProgramText& text) {
  if (request.job != job_ || !wanted_.remove(page_of_line(request.first))) return;
  QStringList lines;
  for (const std::string& line : text.lines) lines.append(to_text(line));
  const quint64 page = page_of_line(request.first);
  ages_.push_front(page);
  pages_.emplace(page, Page{std::move(lines), ages_.begin()});
  if (pages_.size() > kMostPages) forget_oldest_page();
  const int first_row = static_cast<int>(request.first) - 1;
  emit dataChanged(index(first_row), index(first_row + static_cast<int>(request.count) - 1),
                   {Qt::DisplayRole});
}

void ProgramModel::drop_page(const PageRequest& request) {
  if (request.job == job_) wanted_.remove(page_of_line(request.first));
}

void ProgramModel::forget_oldest_page() {
  pages_.erase(ages_.back());
  ages_.pop_back();
}

int ProgramModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(lines_);
}

QVariant ProgramModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount()) return {};
  if (role == Qt::DisplayRole) return line_text(static_cast<quint64>(index.row()));
  if (role == kIsCurrent) return index.row() == current_row();
  const auto problem = problems_.find(index.row());
  if (role == kProblem || role == Qt::ToolTipRole) {
    return problem == problems_.end() ? QString() : problem->second.text;
  }
  if (role == kIsWarning) return problem != problems_.end() && problem->second.warning;
  return {};
}

int ProgramModel::next_problem_row(int row) const {
  if (problems_.empty()) return -1;
  const auto next = problems_.upper_bound(row);
  return next == problems_.end() ? problems_.begin()->first : next->first;
}

QString ProgramModel::line_text(quint64 row) const {
  const auto page = pages_.find(row / kPageLines);
  if (page == pages_.end()) return QStringLiteral("…");
  return page->second.lines.value(static_cast<qsizetype>(row % kPageLines));
}

void ProgramModel::row_changed(int row, const QList<int>& roles) {
  if (row >= 0 && row < rowCount()) emit dataChanged(index(row), index(row), roles);
}

}  // namespace cnc::gui
