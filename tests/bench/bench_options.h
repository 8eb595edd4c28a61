// What the command lines of some benches have in common: numbers by name (p=0.02), and files.
#pragma once

#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace cnc::bench {

class Options {
 public:
  using Values = std::map<std::string, double, std::less<>>;

  /// `values`: the names there are, and what they are unless the command line says otherwise.
  Options(Values values, int count, char** arguments) : values_(std::move(values)) {
    for (int i = 1; i < count; ++i) {
      const std::string_view argument = arguments[i];
      const std::size_t equals = argument.find('=');
      const auto option = values_.find(argument.substr(0, equals));
      if (equals != argument.npos && option != values_.end()) {
        option->second = std::atof(arguments[i] + equals + 1);
      } else {
        files_.emplace_back(argument);
      }
    }
  }

  /// Of a name there is.
  double operator[](std::string_view name) const { return values_.find(name)->second; }
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

 private:
  Values values_;
  std::vector<std::string> files_;
};

}  // namespace cnc::bench
