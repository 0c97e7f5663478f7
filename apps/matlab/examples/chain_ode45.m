function c = chain_ode45(duration_s, tolerance)
%CHAIN_ODE45  The paper's chain by ode45, beside hertzline_run: the same motion.
%   c = CHAIN_ODE45() solves the equations of docs/model.md (sections 3 to 5) for the scene paper-vitreous-carbon: a horn, six
%   spheres and a disc on a spring. It then simulates the same scene with HERTZLINE_RUN, and compares the last sphere and the plate.
%
%   c = CHAIN_ODE45(duration_s, tolerance): simulated time [s], by default 500e-6, and relative tolerance of ode45, by default 1e-8.
%
%   The result c has these fields:
%     t_s, v_last_m_per_s, v_plate_m_per_s  by ode45, [sample x 1]
%     run                                   the result of HERTZLINE_RUN, at the same times
%     difference                            largest difference of both velocities, each over its peak
%     ode45_s, hertzline_s                  elapsed times [s]; hertzline_s includes the start of the program and its files
%
%   Example:
%     c = chain_ode45();
%     plot(c.t_s, c.v_last_m_per_s, c.run.t_s, c.run.v_last_m_per_s, '--')
%
%   See also HERTZLINE_RUN.

if nargin < 1
    duration_s = 500e-6;
end
if nargin < 2
    tolerance = 1e-8;
end

% Symbols of docs/model.md, section 2; SI units
N = 6;                                   % spheres of aluminium
R = 0.5e-3;
m = 2700 * 4/3 * pi * R^3;
lambda = 0.32;                           % damping of a closed contact
F0 = 0.1;                                % preload
A = 3e-6;                                % the horn's amplitude
f = 73e3;
T = 25 / f;                              % 25 periods in a burst with Hann's envelope
a = 5e-3;                                % the disc of vitreous carbon
h = 0.5e-3;
m_plate = 1420 * pi * a^2 * h / 4;       % a quarter of the disc takes part
K = 16 * pi / a^2 * 35e9 * h^3 / (12 * (1 - 0.15^2));

% Hertz's contacts: horn - sphere 1, between spheres, sphere N - disc
modulus = @(E, nu) E / (1 - nu^2);
joint = @(one, other) 1 / (1/one + 1/other);
aluminium = modulus(69e9, 0.33);
k = [4/3 * sqrt(R) * joint(modulus(201e9, 0.30), aluminium)
     sqrt(2*R)/3 * aluminium * ones(N - 1, 1)
     4/3 * sqrt(R) * joint(modulus(35e9, 0.15), aluminium)];
overlap0 = (F0 ./ k).^(2/3);

    function dy = motion(t, y)
        % y: displacements of spheres and plate, then their velocities
        x_horn = 0;
        v_horn = 0;
        if t > 0 && t < T
            envelope = (1 - cos(2*pi*t/T)) / 2;
            slope = pi/T * sin(2*pi*t/T);
            x_horn = A * envelope * sin(2*pi*f*t);
            v_horn = A * (slope * sin(2*pi*f*t) + envelope * 2*pi*f * cos(2*pi*f*t));
        end
        x = [x_horn; y(1 : N+1)];
        v = [v_horn; y(N+2 : end)];
        overlap = overlap0 - diff(x);
        force = k .* max(overlap, 0).^1.5 - lambda * diff(v) .* (overlap > 0);
        dy = [y(N+2 : end)
              -diff(force) / m
              (force(end) - K * y(N+1) - F0) / m_plate];
    end

began = tic;
c.run = hertzline_run('paper-vitreous-carbon', 'output.duration_s', duration_s, 'taps', {'v_last', 'v_plate'});
c.hertzline_s = toc(began);

began = tic;
options = odeset('RelTol', tolerance, 'AbsTol', tolerance * [1e-6 * ones(N + 1, 1); ones(N + 1, 1)], 'MaxStep', 1/f);
[c.t_s, y] = ode45(@motion, c.run.t_s, zeros(2*N + 2, 1), options);
c.ode45_s = toc(began);
c.v_last_m_per_s = y(:, 2*N + 1);
c.v_plate_m_per_s = y(:, 2*N + 2);

apart = @(ours, theirs) max(abs(ours - theirs)) / max(abs(theirs));
c.difference = max(apart(c.v_last_m_per_s, c.run.v_last_m_per_s), apart(c.v_plate_m_per_s, c.run.v_plate_m_per_s));
end
