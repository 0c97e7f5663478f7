% A plane of waveforms has the order of k-Wave's source.p_mask, that of MATLAB's linear index: octave-cli read_field.m PROGRAM
% Each row is compared with the run of a hydrophone at the place that its element of the mask has.
program = argv(){1};
folder = tempname();
mkdir(folder);
file = fullfile(folder, "source.h5");
scene = "wet-vitreous-carbon --set drive.cycles=3 --set output.duration_s=60us";

function run(command)
  [status, text] = system([command " 2>&1"]);
  assert(status, 0, text);
end

run(["'" program "' field " scene " --plane x=1mm..5mm:3,y=2mm,3mm,z=4mm --waveforms -o " file]);
source.p_mask = zeros(8, 7, 6);
source.p_mask(3:5, 4:5, 2) = 1;
[i, j, k] = ind2sub(size(source.p_mask), find(source.p_mask));
h = load("-hdf5", file, "p_points");  % as h5read does, the last dimension first: [sample][point]
source.p = h.p_points';   % [point][time step]
assert(size(source.p), [numel(i), 601]);
places = sprintf("[%gmm,%gmm,4mm],", [1 + 2 * (i - 3), 2 + (j - 4)]');
csv = fullfile(folder, "run.csv");
run(["'" program "' run " scene " --set 'output.points_m=[" places(1:end - 1) "]' --columns p_points -o " csv]);
heard = dlmread(csv, ",", 1, 1)';
assert(size(heard), size(source.p));
assert(max(abs(heard(:))) > 1000);
assert(double(source.p), heard, 1e-4 * max(abs(heard(:))));
assert(norm(heard(1, :) - heard(2, :)) > 0.05 * norm(heard(1, :)));  % neighbours differ, so that the order counts
printf("%d points in the order of the mask\n", numel(i));
confirm_recursive_rmdir(false);
rmdir(folder, "s");
