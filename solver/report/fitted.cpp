#include "report/fitted.hpp"

namespace extremal {

Fitted fitted_of(const FitRequest& request, const FitResult& fit) {
  const Observations& data = request.task.data;
  Fitted fitted{.parameters = request.parameters,
                .open_ends = request.open_ends,
                .values = fit.values,
                .covariance = {},
                .scaled = fit.scaled,
                .chi_squared = fit.chi_squared,
                .freedom = fit.freedom,
                .t = data.t,
                .columns = {}};
  for (Eigen::Index i = 0; i < fit.covariance.rows(); ++i)
    fitted.covariance.emplace_back(fit.covariance.row(i).begin(), fit.covariance.row(i).end());
  for (std::size_t c = 0; c < data.columns.size(); ++c) {
    const ObservedColumn& column = data.columns[c];
    Fitted::Column& to = fitted.columns.emplace_back();
    to.name = column.name;
    for (auto* part : {&to.observed, &to.residual, &to.sigma}) part->resize(data.t.size());
    for (std::size_t k = 0; k < column.values.size(); ++k) {
      const ObservedValue& value = column.values[k];
      to.observed[value.row] = value.value;
      to.residual[value.row] = fit.residuals[c][k];
      if (data.sigmas) to.sigma[value.row] = value.sigma;
    }
  }
  return fitted;
}

}  // namespace extremal
