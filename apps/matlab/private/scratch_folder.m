function [folder, cleanup] = scratch_folder()
%SCRATCH_FOLDER  A folder for the files of one call. It is gone when `cleanup` is.
folder = tempname();
[made, why] = mkdir(folder);
if ~made
    error('hertzline:failed', '%s: %s', folder, why);
end
cleanup = onCleanup(@() remove(folder));
end

function remove(folder)
found = dir(folder);
for k = 1:numel(found)
    if ~found(k).isdir
        delete(fullfile(folder, found(k).name));
    end
end
rmdir(folder);
end
