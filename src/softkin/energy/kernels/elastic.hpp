#pragma once

#include <softkin/core/target.hpp>
#include <softkin/energy/elastic_blocks.hpp>

namespace softkin::energy {

// energy/elastic.hpp, pressure.hpp, dielectric.hpp and viscous.hpp say what they do.
SOFTKIN_KERNELS(
    template <int K, int Q> void elastic_force(const energy::ElasticBlock<K, Q>& block, const energy::Shape<K>& current,
                                               energy::ElasticForce<K>& out);
    template <int K, int Q> void elastic_stress(const energy::ElasticBlock<K, Q>& block,
                                                const energy::Shape<K>& current, energy::Pack33 (&stress)[Q]);
    template <int K, int Q>
    void elastic_stiffness(const energy::ElasticBlock<K, Q>& block, const energy::Shape<K>& current, bool projected,
                           energy::ElasticStiffness<K>& out);
    template <int K, int Q> void turning_pull(const energy::ElasticBlock<K, Q>& block, const energy::Shape<K>& current,
                                              const energy::Shape<K>& step, energy::Shape<K>& pull);

    template <int K, int Q>
    void add_pressure_force(const energy::ElasticBlock<K, Q>& block, const energy::CornerPressure& pressure,
                            const energy::Shape<K>& current, energy::ElasticForce<K>& out,
                            energy::PressureMiss& missed);
    template <int K, int Q>
    void add_pressure_stress(const energy::CornerPressure& pressure, energy::Pack33 (&stress)[Q]);
    template <int K, int Q>
    void add_pressure_stiffness(const energy::ElasticBlock<K, Q>& block, const energy::CornerPressure& pressure,
                                const energy::Shape<K>& current, bool projected, energy::ElasticStiffness<K>& out,
                                energy::PressureCoupling<K>& coupling);

    void add_dielectric_force(const energy::DielectricPrisms& prisms, const energy::Pack& permittivity,
                              double voltage_kV, const energy::Shape<6>& current, energy::ElasticForce<6>& out);
    void add_maxwell_stress(const energy::DielectricPrisms& prisms, const energy::Pack& permittivity, double voltage_kV,
                            const energy::Shape<6>& current, energy::Pack33 (&stress)[6]);
    void add_dielectric_stiffness(const energy::DielectricPrisms& prisms, const energy::Pack& permittivity,
                                  double voltage_kV, const energy::Shape<6>& current, energy::ElasticStiffness<6>& out);

    template <int Q> void begin_step(const energy::ViscousBlock& viscous, double* begun); template <int K, int Q>
    void add_viscous_force(const energy::ElasticBlock<K, Q>& block, const energy::ViscousBlock& viscous,
                           const energy::Shape<K>& current, energy::ElasticForce<K>& out);
    template <int K, int Q>
    void add_viscous_stiffness(const energy::ElasticBlock<K, Q>& block, const energy::ViscousBlock& viscous,
                               const energy::Shape<K>& current, bool projected, energy::ElasticStiffness<K>& out);
    template <int K, int Q>
    void add_viscous_stress(const energy::ElasticBlock<K, Q>& block, const energy::ViscousBlock& viscous,
                            const energy::Shape<K>& current, energy::Pack33 (&stress)[Q]);
    template <int K, int Q>
    void flow(const energy::ElasticBlock<K, Q>& block, const energy::ViscousBlock& viscous, const energy::Pack* rate,
              const energy::Shape<K>& current, double* strains, double* kept);)

/// throws  InvalidInput
[[noreturn]] void refuse_law(Law law);

}  // namespace softkin::energy
