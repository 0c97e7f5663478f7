% Tests the functions of apps/matlab under Octave: octave-cli matlab_functions.m ROOT TEST, with the program in HERTZLINE.
% Each function without arguments is a test of its own.
1;

function a_run_has_the_samples_and_numbers_of_the_program()
  folder = scratch();
  r = hertzline_run('paper-vitreous-carbon', 'chain.preload_n', 0.3, 'taps', {'v_last', 'v_chain', 'f_first'}, 'measure', 'f_last', ...
                    'save', {fullfile(folder, 'a.csv'), fullfile(folder, 'b.npy')});
  assert(exist(fullfile(folder, 'b.npy'), 'file') == 2);
  text = program('run paper-vitreous-carbon --set chain.preload_n=0.3 --columns v_last,v_chain,f_first -o %s --json --measure f_last', ...
                         fullfile(folder, 'c.csv'));
  assert(fileread(fullfile(folder, 'a.csv')), fileread(fullfile(folder, 'c.csv')));
  csv = dlmread(fullfile(folder, 'c.csv'), ',', 1, 0);
  assert(size(csv), [5001 9]);
  assert(isequal(r.t_s, csv(:, 1)));
  assert(isequal([r.v_last_m_per_s, r.v_chain_m_per_s, r.f_first_n], column_of(csv, folder, {'v_last_m_per_s', ...
    'v1_m_per_s', 'v2_m_per_s', 'v3_m_per_s', 'v4_m_per_s', 'v5_m_per_s', 'v6_m_per_s', 'f_first_n'})));
  assert(isequal(r.v_chain_m_per_s(:, 6), r.v_last_m_per_s));
  assert(r.sample_rate_hz == 1e7);
  for name = {'peak_v_out_m_per_s', 'thd_r', 'energy_residual', 'step_s', 'peak_contact_pressure_pa', 'estimated_error'}
    assert(r.summary.(name{1}), number_in(text, name{1}));  % to the last bit
  end
  list = regexp(text, '"harmonics_db":\[([^\]]*)\]', 'tokens');
  assert(isequal(r.summary.harmonics_db, str2double(strsplit(list{1}{1}, ','))'));
  assert(isequal(r.summary.f_last.harmonics_db, str2double(strsplit(list{2}{1}, ','))'));
  assert(r.summary.scene_hash, r.provenance.scene_hash);
  assert(size(r.warnings, 2) == 1 && ~isempty(strfind(strjoin(r.warnings'), 'yields')));
  assert(~isfield(r.summary, 'warnings') && ~isfield(r.summary, 'recordings'));
end

function spectra_belong_to_the_samples()
  r = hertzline_run('paper-vitreous-carbon', 'measure', 'v_last');
  [~, strongest] = max(r.spectrum.v_out_m_per_s);
  assert(abs(r.spectrum.frequency_hz(strongest) - r.summary.strongest_hz) <= diff(r.spectrum.frequency_hz(1:2)));
  % amplitudes of a line are to each other as the sums over the samples
  line = find(r.spectrum.frequency_hz >= 146e3, 1);
  sum_of = @(v) abs(sum(v .* exp(-2i * pi * r.spectrum.frequency_hz(line) * r.t_s)));
  ratio = r.spectrum.v_out_m_per_s(line) / r.spectrum.v_last_m_per_s(line);
  assert(ratio, sum_of(r.v_out_m_per_s) / sum_of(r.v_last_m_per_s), 0.02);
end

function an_empty_value_takes_one_back()
  r = hertzline_run('paper-stream', 'numerics.step_s', [], 'output.duration_s', 2e-5);
  assert(isempty(r.provenance.asked_numerics.step_s));
  fails('wrongUse', {'chain.preload_n: found nan'}, @() hertzline_run('paper-wall', 'chain.preload_n', NaN));
end

function a_quiet_run_has_empty_warnings()
  r = hertzline_run('paper-wall', 'drive.amplitude_m', 0, 'chain.preload_n', '1 mN', 'output.duration_s', '20 us');
  assert(isequal(size(r.warnings), [0 1]) && iscell(r.warnings));
  assert(~any(r.v_last_m_per_s));  % a horn at rest moves nothing
end

function a_struck_chain_keeps_its_momentum_and_energy()
  spheres = 8;
  r = hertzline_run('striker', 'chain.diameters_m', 2e-3 * ones(1, spheres), 'chain.spheres', spheres, 'end.kind', 'free', ...
                    'chain.impact_velocity_m_per_s', 0.5, 'taps', 'v_chain', 'numerics.accuracy', 1e-9);
  momentum = sum(r.v_chain_m_per_s, 2);
  assert(momentum, 0.5 * ones(size(momentum)), 1e-8);
  assert(sum(r.v_chain_m_per_s(end, :).^2), 0.25, 1e-6);  % the spheres have parted
  assert(r.v_chain_m_per_s(end, end) > 0.98 * 0.5);  % and the last one has nearly all
end

function the_script_of_ode45_moves_alike()
  c = chain_ode45(60e-6, 1e-8);
  assert(numel(c.t_s) == 601 && max(abs(c.v_last_m_per_s)) > 0.01);
  assert(c.difference < 5e-4);
  assert(c.difference < 10 * c.run.summary.estimated_error);
end

function a_scene_goes_through_a_struct_unchanged()
  names = {'paper-vitreous-carbon', 'wet-layers', 'seven-chains', 'tapered-chain', 'striker', 'wet-off-axis'};
  for name = names
    s = hertzline_scene(name{1});
    assert(isequal(hertzline_scene(s), s), name{1});
  end
  s = hertzline_scene('paper-pyrex', 'drive.cycles', 7);
  assert(s.drive.cycles == 7 && s.xEnd.thickness_m == 0.5e-3 && strcmp(s.xEnd.material, 'pyrex'));
  assert(isempty(s.numerics.step_s) && isempty(s.numerics.integrator));  % the program's choice is left to it
  s.chain.preload_n = 0.1 + 0.2;  % no short decimal number
  s.materials.clay = struct('density_kg_per_m3', 1900, 'youngs_modulus_pa', 1e10, 'poissons_ratio', 0.3);
  s.xEnd.material = 'clay';
  r = hertzline_run(s, 'end.thickness_m', '0.6 mm');
  text = program(['run paper-pyrex --set drive.cycles=7 --set chain.preload_n=0.30000000000000004 --set end.material=clay ' ...
                  '--set end.thickness_m=0.6e-3 --set materials.clay.density=1900 --set materials.clay.youngs_modulus_pa=1e10 --set materials.clay.poissons_ratio=0.3 --json']);
  assert(r.summary.scene_hash, regexp(text, '"scene_hash":"(\w+)"', 'tokens', 'once'){1});
  assert(r.summary.peak_v_out_m_per_s, number_in(text, 'peak_v_out_m_per_s'));
end

function lists_of_one_entry_stay_lists()
  s = hertzline_scene('wet-vitreous-carbon', 'array.x_m', 1e-3, 'array.y_m', 0, 'output.points_m', [0 0 0.02], 'end.materials', 'pyrex', ...
                      'end.thicknesses_m', 0.5e-3);
  assert(s.array.x_m == 1e-3 && isequal(s.output.points_m, [0 0 0.02]) && isequal(s.xEnd.materials, {'pyrex'}));
  s.output.points_m = [0 0 0.02; 1e-3 0 0.03];
  s.output.duration_s = 60e-6;
  assert(isequal(hertzline_scene(s), s));
  r = hertzline_run(s, 'taps', 'p_points');
  assert(size(r.p_points_pa), [601 2]);
end

function a_record_moves_the_horn()
  t = (0:2999)' / 1e7;
  s = hertzline_scene('paper-wall', 'drive.frequency_hz', 73e3);
  s.drive.kind = 'file';
  s.drive.samples = 1e-6 * (1 - cos(2*pi*t/t(end))) / 2 .* sin(2*pi*73e3*t);
  s.drive.sample_rate_hz = 1e7;
  assert(isequal(hertzline_scene(s).drive.samples, s.drive.samples));
  r = hertzline_run(s, 'taps', {'x_horn', 'v_last'});
  assert(max(abs(r.x_horn_m(1:3000) - s.drive.samples)) < 1e-5 * 1e-6);
  assert(max(abs(r.v_last_m_per_s)) > 0.01);
end

function a_sweep_has_the_rows_of_runs()
  thickness_m = [0.3e-3, 0.1 / 300, 0.7e-3];
  t = hertzline_sweep('paper-vitreous-carbon', {'end.thickness_m', thickness_m, 'chain.material', {'steel', 'aluminium'}}, ...
                      'drive.cycles', 10, 'measure', 'v_plate', 'jobs', 1);
  assert(isequal(t.point, (0:5)') && isequal(t.xEnd.thickness_m, kron(thickness_m', [1; 1])));
  assert(isequal(t.chain.material, repmat({'steel'; 'aluminium'}, 3, 1)) && all(strcmp(t.status, 'ok')));
  r = hertzline_run('paper-vitreous-carbon', 'drive.cycles', 10, 'end.thickness_m', t.xEnd.thickness_m(4), 'measure', 'v_plate', ...
                    'numerics.step_s', t.step_s(4), 'numerics.integrator', t.integrator{4});
  for name = {'peak_v_out_m_per_s', 'thd_r', 'occupied_20db_hz', 'contact_events'}
    column = t.(name{1});
    assert(column(4), r.summary.(name{1}));
  end
  assert(t.scene_hash{4}, r.summary.scene_hash);
  assert(t.harmonics_db_3(4), r.summary.harmonics_db(3));
  assert(t.v_plate.thd_r(4), r.summary.v_plate.thd_r);
  assert(~isempty(strfind(t.message{4}, 'rings')));
  assert(t.provenance.scene.drive.cycles == 10);
end

function a_point_that_cannot_be_simulated_is_a_row()
  t = hertzline_sweep('paper-wall', {'numerics.step_s', [1e-7, 1e-3]}, 'numerics.integrator', 'leapfrog', 'quantities', {'thd_r', 'rows'});
  assert(isequal(t.status, {'ok'; 'refused'}));
  assert(isnan(t.thd_r(2)) && ~isnan(t.thd_r(1)) && ~isempty(t.message{2}));
  assert(~isfield(t, 'peak_v_out_m_per_s'));
  t = hertzline_sweep('paper-wall', {'drive.file', {'/nosuch.csv'}}, 'drive.kind', 'file', 'quantities', 'thd_r');
  assert(t.message{1}, 'drive.file: found "/nosuch.csv", which is no file, allowed: a recording');
end

function points_and_sequences_are_swept()
  folder = scratch();
  file = fullfile(folder, 'a ü.csv');
  hertzline_run('paper-wall', 'taps', 'v_horn', 'save', file);
  t = hertzline_sweep('paper-wall', {}, 'points', {'drive.file', {file, file}, 'drive.scale', [1, 0.5]}, 'drive.kind', 'file', ...
                      'quantities', 'peak_v_last_m_per_s');
  assert(isequal(t.drive.file, {file; file}) && isequal(t.drive.scale, [1; 0.5]));
  assert(t.peak_v_last_m_per_s(1) > t.peak_v_last_m_per_s(2));
  t = hertzline_sweep('paper-wall', {'drive.file', {file}}, 'drive.kind', 'file', 'quantities', 'peak_v_last_m_per_s');
  assert(isequal(t.drive.file, {file}) && t.peak_v_last_m_per_s > 0.01);
  t = hertzline_sweep('paper-wall', {'chain.preload_n', {'0.1 N', '200 mN'}}, 'quantities', 'thd_r');
  assert(isequal(t.chain.preload_n, [0.1; 0.2]));
  t = hertzline_sweep('paper-wall', {}, 'points', {'chain.preload_n'; [0.1, 0.2]}, 'quantities', 'thd_r');
  assert(isequal(t.chain.preload_n, [0.1; 0.2]));
  t = hertzline_sweep('paper-wall', {'chain.preload_n', '0.1..1:log', 'chain.spheres', '3..5'}, 'sobol', 8, 'quantities', 'thd_r');
  assert(numel(t.point) == 8 && all(t.chain.preload_n >= 0.1 & t.chain.preload_n <= 1) && isequal(unique(t.chain.spheres), [3; 4; 5]));
end

function a_search_finds_the_best_row_within_the_bounds()
  f = hertzline_optimise('paper-vitreous-carbon', {'chain.preload_n', '0.05..1:log', 'end.material', {'pyrex', 'acrylic'}}, 'drive.cycles', 10, ...
                         'maximise', 'thd_r', 'subject_to', {'peak_v_out_m_per_s >= 0.1', 'peak_v_last_m_per_s <= 3'}, 'evaluations', 60, 'seed', intmax('uint64'));
  kept = f.table.peak_v_out_m_per_s >= 0.1 & f.table.peak_v_last_m_per_s <= 3;
  assert(numel(f.table.point) <= 60 && any(kept));
  assert(f.best.thd_r, max(f.table.thd_r(kept)));
  assert(f.best_scene.chain.preload_n, f.best.chain.preload_n);
  assert(f.best_scene.xEnd.material, f.best.xEnd.material);
  assert(f.best_scene.drive.cycles == 10);
  assert(hertzline_run(f.best_scene).summary.thd_r, f.best.thd_r, 1e-3);
  assert(f.summary.best.point == f.best.point && f.summary.seed == double(intmax('uint64')) && iscell(f.warnings));
  f = hertzline_optimise('paper-wall', {'chain.preload_n', '0.1..1'}, 'minimise', 'thd_r', ...
                         'subject_to', 'peak_v_out_m_per_s >= 30', 'evaluations', 20);
  assert(isempty(f.best) && isempty(f.best_scene) && f.summary.feasible == 0);
  assert(~isempty(strfind(f.warnings{end}, 'peak_v_out_m_per_s >= 30 is required')));
end

function errors_carry_every_fault()
  allowed = 'chain.preload_n: found -0.1, allowed: a number from 0 to 1e+09 N';
  fails('wrongUse', {allowed, 'end.kind: found "foo", allowed: one of "plate", "wall", "free"', 'taps: found "v_foo", allowed: v_out, '}, ...
        @() hertzline_run('paper-wall', 'chain.preload_n', -0.1, 'end.kind', 'foo', 'taps', 'v_foo'));
  s = hertzline_scene('paper-wall');
  s.chain.preload_n = -0.1;
  s.drive.frequncy_hz = 3;
  fails('wrongUse', {allowed, 'drive.frequncy_hz: found an unknown key, allowed: '}, @() hertzline_run(s));
  fails('wrongUse', {allowed, 'drive.frequncy_hz'}, @() hertzline_scene(s));
  fails('wrongUse', {'nosuch: found no such file or shipped scene, allowed: a file, or one of '}, @() hertzline_scene('nosuch'));
  fails('wrongUse', {'vary chain.preload_n=-0.1,1: ', allowed, 'vary a.b=3: found "a.b"', 'jobs: '}, ...
        @() hertzline_sweep('paper-wall', {'chain.preload_n', [-0.1 1], 'a.b', 3}, 'jobs', 0));
  fails('wrongUse', {'thd_q'}, @() hertzline_optimise('paper-wall', {'chain.preload_n', '0.1..1'}, 'maximise', 'thd_q'));
  fails('wrongUse', {'stream: found "v_foo", allowed: v_out', 'timeout_s: found -1, allowed: a finite number above 0'}, ...
        @() hertzline_listen('tcp://127.0.0.1:1', 10, 'stream', 'v_foo', 'timeout_s', -1));
  fails('failed', {'cannot'}, @() hertzline_run('paper-wall', 'save', '/nosuch/a.csv'));
  fails('failed', {'B of memory'}, @() hertzline_run('paper-wall', 'output.duration_s', 1e4));
  setenv('HERTZLINE', '/nosuch/hertzline');
  fails('notFound', {['/nosuch/hertzline: found no such program, allowed: hertzline on the PATH, or its file in the environment ' ...
                      'variable HERTZLINE']}, ...
        @() hertzline_run('paper-wall'));
end

function wrong_arguments_are_refused_before_the_program_runs()
  setenv('HERTZLINE', '/nosuch/hertzline');
  fails('wrongUse', {'hertzline_run: found the option "tap", allowed: taps, measure, band_from_hz, save, a key of the scene'}, ...
        @() hertzline_run('paper-wall', 'tap', 'v_out'));
  fails('wrongUse', {'hertzline_run: found 1 arguments behind the first ones, allowed: pairs'}, @() hertzline_run('paper-wall', 'taps'));
  fails('wrongUse', {'hertzline_run: found a scene of class double, allowed: '}, @() hertzline_run(3));
  fails('wrongUse', {'hertzline_sweep: found a double, allowed: the name of a key'}, @() hertzline_sweep('paper-wall', {}, 3, 4));
  fails('wrongUse', {'vary: found a double of 1 entries, allowed: a cell {KEY, VALUES, ...}'}, @() hertzline_sweep('paper-wall', 3));
  fails('wrongUse', {'vary chain.preload_n: found no values, allowed: at least one'}, @() hertzline_sweep('paper-wall', {'chain.preload_n', []}));
  fails('wrongUse', {'vary chain.preload_n: found 10000 values, allowed: as many as "points"'}, ...
        @() hertzline_sweep('paper-wall', {'chain.preload_n', linspace(1/3, 1, 10000)}));
  fails('wrongUse', {'points: found 4 entries with columns of 2, 3 values, allowed: '}, ...
        @() hertzline_sweep('paper-wall', {}, 'points', {'chain.preload_n', [1 2], 'chain.spheres', [1 2 3]}));
  fails('wrongUse', {'band_from_hz: found 2 values, allowed: one'}, @() hertzline_run('paper-wall', 'band_from_hz', [1 2]));
  fails('wrongUse', {'taps: found a function_handle, allowed: numbers, a text or a cell of texts'}, @() hertzline_run('paper-wall', 'taps', @sin));
  fails('wrongUse', {'gaps: found "skip", allowed: "raise", "mark"'}, @() hertzline_listen('', [], 'gaps', 'skip'));
  fails('wrongUse', {'found the option "chain.preload_n", allowed: stream'}, @() hertzline_listen('', [], 'chain.preload_n', 1));
  fails('wrongUse', {'drive: found a double, allowed: a struct of the keys of this section'}, @() hertzline_run(struct('drive', 3)));
end

function listening_gives_the_samples_of_a_run()
  [endpoint, stopping] = stream('stream paper-stream --pace flat-out --duration 1e-3 --wait-for-subscriber');
  b = hertzline_listen(endpoint, 5000, 'stream', 'v_chain');
  r = hertzline_run('paper-stream', 'taps', 'v_chain', 'output.duration_s', 1e-3);
  assert(class(b.v_chain_m_per_s), 'single');
  assert(isequal(b.v_chain_m_per_s, single(r.v_chain_m_per_s(1:5000, :))) && any(b.v_chain_m_per_s(:)));
  assert(isequal(b.t_s, r.t_s(1:5000)) && isequal(b.sample, (0:4999)'));
  assert(b.missing == 0 && isequal(size(b.gaps.missing), [0 1]) && b.summary.gapless && b.summary.fs == 1e7);
  assert(b.summary.ended_by, 'duration');
  assert(b.provenance.scene.chain.spheres == 6);
end

function gaps_are_counted()
  folder = scratch();
  file = fopen(fullfile(folder, 'gaps.csv'), 'w');
  numbers = [0:99, 150:199, 1000:1099];  % 50 and 800 samples are missing
  fprintf(file, 't_s,v_out_m_per_s\n');
  fprintf(file, '%.17g,%.17g\n', [numbers / 1e6; sin(numbers)]);
  fclose(file);
  command = sprintf('replay %s --pace flat-out --wait-for-subscriber', fullfile(folder, 'gaps.csv'));
  [endpoint, stopping] = stream(command);
  b = hertzline_listen(endpoint, [], 'gaps', 'mark');
  assert(isequal(b.sample, numbers') && isequal(b.v_out_m_per_s, single(sin(numbers'))));
  assert(isequal(b.gaps, struct('before_sample', [150; 1000], 'missing', [50; 800])) && b.missing == 850);
  assert(~b.summary.gapless && ~isempty(strfind(strjoin(b.warnings'), '50 samples are missing before sample 150')));
  [endpoint, stopping] = stream(command);
  fails('gap', {'850 samples are missing', 'the stream is incomplete'}, @() hertzline_listen(endpoint));
end

function a_silent_stream_is_an_error()
  fails('failed', {'nothing arrived for 0.1 s from tcp://127.0.0.1:1', 'no samples of v_out were received'}, ...
        @() hertzline_listen('tcp://127.0.0.1:1', 10, 'timeout_s', 0.1, 'gaps', 'mark'));
end

function any_name_of_a_file_is_taken()
  folder = fullfile(scratch(), ['Schöner Ordner, $HOME''s "`x`;' char(9) '*']);
  mkdir(folder);
  text = program('scenes paper-acrylic --unresolved');
  file = fopen(fullfile(folder, 'größe 1.toml'), 'w');
  fputs(file, text);
  fclose(file);
  r = hertzline_run(fullfile(folder, 'größe 1.toml'), 'save', fullfile(folder, 'ü.csv'));
  assert(exist(fullfile(folder, 'ü.csv'), 'file') == 2);
  assert(r.provenance.scene.xEnd.material, 'acrylic');
  here = cd(folder);
  s = hertzline_scene('paper-acrylic');
  s.drive.kind = 'file';
  s.drive.file = 'ü.csv';
  s.drive.column = 'v_out_m_per_s';
  driven = hertzline_run(s, 'taps', 'v_horn');
  cd(here);
  assert(max(abs(driven.v_horn_m_per_s)) > 0.01);
end

function nothing_is_left_behind()
  folder = scratch();
  setenv('TMPDIR', folder);
  hertzline_run('paper-wall');
  hertzline_sweep('paper-wall', {'chain.spheres', [3 4]});
  s = hertzline_scene('paper-wall');
  fails('wrongUse', {'chain.preload_n'}, @() hertzline_run(s, 'chain.preload_n', -1));
  fails('wrongUse', {'nosuch'}, @() hertzline_run(s, 'nosuch', -1));
  assert(numel(dir(folder)) == 2, strjoin({dir(folder).name}, ' '));
end

function the_language_is_that_of_both()
  files = sources();
  assert(numel(files) > 15);
  for file = files
    lines = strsplit(fileread(file{1}), sprintf('\n'));
    code = regexprep(lines, '^\s*%.*$', '');
    code = regexprep(code, '''[^'']*''', '');
    code = regexprep(code, '%.*$', '');
    bad = ~cellfun(@isempty, regexp(code, ['["#!]|[-+*/|&^]=|\+\+|--|\)[({]|\<end(if|for|while|function|switch|_)|' ...
                                           '\<(unwind_protect|printf|fputs|puts|do|until|argv)\>'], 'once'));
    assert(~any(bad), sprintf('%s: %s', file{1}, strjoin(lines(bad), ' | ')));
  end
end

function each_function_has_help_with_an_example()
  for name = {'run', 'scene', 'sweep', 'optimise', 'listen'}
    text = help(['hertzline_' name{1}]);
    assert(~isempty(strfind(text, ['HERTZLINE_' upper(name{1}) '  '])), name{1});
    for word = {'Example:', 'Errors:', 'See also'}
      assert(~isempty(strfind(text, word{1})), name{1});
    end
  end
end

function the_examples_run()
  [endpoint, stopping] = stream('stream paper-stream');
  texts = {};
  for name = {'run', 'scene', 'sweep', 'optimise', 'listen'}
    example = regexp(fileread(which(['hertzline_' name{1}])), '%   Example:[^\n]*\n(.*?)%\n', 'tokens', 'once');
    texts{end + 1} = regexprep(example{1}, '^%', '', 'lineanchors');
  end
  for file = {'apps/matlab/README.md', 'docs/matlab.md'}
    blocks = regexp(fileread(fullfile(root(), file{1})), '```matlab\n(.*?)```', 'tokens');
    assert(~isempty(blocks), file{1});
    texts = [texts, [blocks{:}]];
  end
  for text = texts
    code = strrep(text{1}, 'tcp://127.0.0.1:5573', endpoint);
    code = regexprep(code, '^\s*(addpath|plot|semilogx)\([^\n]*', '', 'lineanchors');  % no display
    code = strrep(code, 'chain_ode45()', 'chain_ode45(20e-6, 1e-5)');
    here = cd(scratch());
    evalc(code);
    cd(here);
  end
end

% What the tests share

function folder = root()
  folder = argv(){1};
end

function files = sources()
  files = {};
  for folder = {'apps/matlab', 'apps/matlab/private', 'apps/matlab/examples'}
    found = glob(fullfile(root(), folder{1}, '*.m'));
    files = [files, found'];
  end
end

function folder = scratch()
  % A folder that is removed with the test's.
  persistent made
  if isempty(made)
    made = tempname();
    mkdir(made);
    atexit('remove_scratch');
  end
  folder = tempname(made);
  mkdir(folder);
end

function remove_scratch(varargin)
  confirm_recursive_rmdir(false);
  rmdir(fileparts(scratch()), 's');
end

function text = program(words, varargin)
  [status, text] = system(sprintf(['"%s" ' words ' 2>/dev/null'], getenv('HERTZLINE'), varargin{:}));
  assert(status == 0, text);
end

function number = number_in(text, name)
  number = str2double(regexp(text, ['"' name '":([^,}]*)'], 'tokens', 'once'){1});
end

function columns = column_of(csv, folder, names)
  handle = fopen(fullfile(folder, 'c.csv'));
  head = strsplit(fgetl(handle), ',');
  fclose(handle);
  [there, places] = ismember(names, head);
  assert(all(there));
  columns = csv(:, places);
end

function fails(kind, texts, call)
  try
    call();
  catch error
    assert(error.identifier, ['hertzline:' kind]);
    for text = texts
      assert(~isempty(strfind(error.message, text{1})), sprintf('%s\nis not in\n%s', text{1}, error.message));
    end
    assert(isempty(strfind(error.message, '/tmp/oct-')), error.message);
    return
  end
  assert(false, ['no error, but: ' texts{1}]);
end

function [endpoint, stopping] = stream(words)
  % Starts the program, and ends it when `stopping` is gone.
  said = tempname(scratch());
  [~, pid] = system(sprintf('"%s" %s --bind "tcp://127.0.0.1:*" --json >/dev/null 2>"%s" </dev/null & echo $!', getenv('HERTZLINE'), words, said));
  stopping = onCleanup(@() system(sprintf('kill %s 2>/dev/null', strtrim(pid))));
  for tries = 1:1000
    found = regexp(fileread(said), 'endpoint (\S+)', 'tokens', 'once');
    if ~isempty(found)
      endpoint = found{1};
      return
    end
    pause(0.1);
  end
  error('no endpoint, but: %s', fileread(said));
end

addpath(fullfile(root(), 'apps/matlab'), fullfile(root(), 'apps/matlab/examples'));
feval(argv(){2});
