// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include <fstream>
#include <stdexcept>
#include <string>

namespace toile::test {

/// A published JSON schema of the project.
class Schema {
public:
    /// `file` below the project's docs/.
    explicit Schema(const std::string& file) {
        std::ifstream in(std::string(TOILE_SOURCE_DIR) + "/docs/" + file);
        if (!in) throw std::runtime_error("no schema " + file);
        const nlohmann::json text = nlohmann::json::parse(in);
        valijson::SchemaParser(valijson::SchemaParser::kDraft7)
            .populateSchema(valijson::adapters::NlohmannJsonAdapter(text), schema_);
    }

    /// What is wrong with the document; empty when it is valid.
    std::string complaints(const std::string& document) const {
        const nlohmann::json json = nlohmann::json::parse(document);
        valijson::Validator validator;
        valijson::ValidationResults results;
        if (validator.validate(schema_, valijson::adapters::NlohmannJsonAdapter(json), &results)) return "";
        std::string all;
        valijson::ValidationResults::Error error;
        while (results.popError(error)) {
            for (const std::string& place : error.context)
                all += place;
            all += ": " + error.description + "\n";
        }
        return all.empty() ? "invalid" : all;
    }

private:
    valijson::Schema schema_;
};

} // namespace toile::test
