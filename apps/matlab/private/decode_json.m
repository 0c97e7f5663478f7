function value = decode_json(text)
%DECODE_JSON  jsondecode, with numbers that are correct to the last bit: Octave's errs by up to three units in the last place.
value = jsondecode(text);
numbers = regexp(regexprep(text, '"[^"\\]*(?:\\.[^"\\]*)*"', ''), '-?\d[-+.eE\d]*', 'match');
[value, used] = corrected(value, str2double(numbers), 0);
if used ~= numel(numbers)
    error('hertzline:failed', 'JSON of the program: found %d numbers of %d', used, numel(numbers));
end
end

function [value, used] = corrected(value, numbers, used)
% The numbers in the order of the text, which is that of fields, entries and rows.
if isstruct(value)
    names = fieldnames(value);
    for k = 1:numel(value)
        for n = 1:numel(names)
            [value(k).(names{n}), used] = corrected(value(k).(names{n}), numbers, used);
        end
    end
elseif iscell(value)
    for k = 1:numel(value)
        [value{k}, used] = corrected(value{k}, numbers, used);
    end
elseif isnumeric(value) && ~isempty(value)
    order = ndims(value):-1:1;
    rows = permute(value, order);
    there = ~isnan(rows);  % null is NaN
    near = reshape(rows(there), 1, []);
    exact = numbers(used + 1 : used + numel(near));
    if any(abs(exact - near) > 1e-12 * abs(exact))
        error('hertzline:failed', 'JSON of the program: found numbers in another order');
    end
    rows(there) = exact;
    used = used + numel(exact);
    value = permute(rows, order);
end
end
