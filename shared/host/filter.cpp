// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/filter.h"

#include <cstdio>

namespace parts::host {

namespace {

Parameter make(Parameter::Kind kind, std::string name, std::string label, std::string help) {
  Parameter p;
  p.kind = kind;
  p.name = std::move(name), p.label = std::move(label), p.help = std::move(help);
  return p;
}

Parameter with_range(Parameter p, double value, double min, double max) {
  p.value = value, p.min = min, p.max = max;
  return p;
}

}  // namespace

Parameter flag(std::string name, bool value, std::string label, std::string help) {
  return with_range(make(Parameter::Kind::Flag, std::move(name), std::move(label), std::move(help)), value, 0, 1);
}

Parameter integer(std::string name, int value, int min, int max, std::string label, std::string help) {
  return with_range(make(Parameter::Kind::Integer, std::move(name), std::move(label), std::move(help)), value, min,
                    max);
}

Parameter number(std::string name, double value, double min, double max, std::string label, std::string help) {
  return with_range(make(Parameter::Kind::Number, std::move(name), std::move(label), std::move(help)), value, min, max);
}

Parameter length(std::string name, double value, std::string label, std::string help) {
  return with_range(make(Parameter::Kind::Length, std::move(name), std::move(label), std::move(help)), value, 0,
                    std::numeric_limits<double>::max());
}

Parameter choice(std::string name, int value, std::vector<std::string> values, std::string label, std::string help) {
  Parameter p = with_range(make(Parameter::Kind::Choice, std::move(name), std::move(label), std::move(help)), value, 0,
                           double(values.size()) - 1);
  p.values = std::move(values);
  return p;
}

Parameter point(std::string name, const Vec3& value, std::string label, std::string help) {
  Parameter p = make(Parameter::Kind::Point, std::move(name), std::move(label), std::move(help));
  p.point = value;
  return p;
}

Parameter text(std::string name, std::string value, std::string label, std::string help) {
  Parameter p = make(Parameter::Kind::Text, std::move(name), std::move(label), std::move(help));
  p.text = std::move(value);
  return p;
}

Parameter open_file(std::string name, std::vector<std::string> endings, std::string label, std::string help) {
  Parameter p = make(Parameter::Kind::OpenFile, std::move(name), std::move(label), std::move(help));
  p.values = std::move(endings);
  return p;
}

Parameter save_file(std::string name, std::string ending, std::string label, std::string help) {
  Parameter p = make(Parameter::Kind::SaveFile, std::move(name), std::move(label), std::move(help));
  p.values = {std::move(ending)};
  return p;
}

Parameter current_layer(std::string name, std::string label, std::string help) {
  return make(Parameter::Kind::CurrentLayer, std::move(name), std::move(label), std::move(help));
}

Parameter other_layer(std::string name, std::string label, std::string help) {
  return make(Parameter::Kind::OtherLayer, std::move(name), std::move(label), std::move(help));
}

void log_value(Progress& progress, const char* name, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  log_value(progress, name, std::string(text));
}

void log_value(Progress& progress, const char* name, const std::string& value) {
  progress.log(std::string(name) + ": " + value);
}

}  // namespace parts::host
